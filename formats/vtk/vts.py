"""VTK XML structured grids, ``.vts``, with raw appended little-endian float64 arrays.

https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import math
import struct
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import only_one
from meshonet.formats.mesh.metadata import Facts, facts_of
from meshonet.formats.vtk import escaped, points_of
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_HEAD = """\
<?xml version="1.0"?>
<VTKFile type="StructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <StructuredGrid WholeExtent="{extent}">
{lines}
      <Points>
        <DataArray type="Float64" Name="Points" NumberOfComponents="3" format="appended" offset="0"/>
      </Points>
    </Piece>
  </StructuredGrid>
  <AppendedData encoding="raw">
   _"""
"""The XML before the appended data."""


def write(
    path: Path,
    grid: Grid,
    cell_data: Mapping[str, NDArray[Any]] | None = None,
    *,
    facts: Facts | None = None,
    block: int = 0,
) -> None:
    """Write a block of `grid`, with cell data (ni-1, nj-1[, nk-1]) and metadata (`facts`) by name."""
    nodes = grid.blocks[block].nodes
    cells = dict(cell_data or {})
    for name, values in cells.items():
        cells[name] = _cell_values(name, values, nodes)
    facts = facts_of(grid) if facts is None else facts
    ni, nj, nk = (*grid.blocks[block].counts, 1)[:3]
    with path.open("wb") as stream:
        stream.write(_head((ni, nj, nk), facts, cells).encode())
        stream.write(struct.pack("<Q", 24 * ni * nj * nk))
        for points in points_of(nodes, "<f8"):
            stream.write(points.data)
        for values in cells.values():
            stream.write(struct.pack("<Q", values.nbytes))
            stream.write(values.data)
        stream.write(b"\n  </AppendedData>\n</VTKFile>\n")


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the only grid of `grids`, which must have one block, as ``.vts``."""
    write(path, only_one(grids, "a .vts file"))


def _head(dims: tuple[int, int, int], facts: Facts, cells: Mapping[str, NDArray[Any]]) -> str:
    extent = "0 {} 0 {} 0 {}".format(*(np.array(dims) - 1))
    offset = 8 + 24 * math.prod(dims)
    arrays = []
    for name, values in cells.items():
        kind = "Float64" if values.dtype.kind == "f" else "Int64"
        tag = f'DataArray type="{kind}" Name="{escaped(name)}" format="appended" offset="{offset}"'
        arrays.append(f"        <{tag}/>")
        offset += 8 + values.nbytes
    cell_data = ["      <CellData>", *arrays, "      </CellData>"] if arrays else ["      <CellData/>"]
    field_data = []  # VTK spells strings as signed bytes, each string ended by a zero
    for name, texts in facts.items():
        codes = " ".join(map(str, np.frombuffer("\0".join([*texts, ""]).encode(), np.int8)))
        tag = f'Array type="String" Name="{name}" NumberOfTuples="{len(texts)}" format="ascii"'
        field_data.append(f"      <{tag}>{codes}</Array>")
    field_data = ["    <FieldData>", *field_data, "    </FieldData>"]
    lines = (*field_data, f'    <Piece Extent="{extent}">', "      <PointData/>", *cell_data)
    return _HEAD.format(extent=extent, lines="\n".join(lines))


def _cell_values(name: str, values: NDArray[Any], nodes: Floats) -> NDArray[Any]:
    """Return cell `values` in VTK's order, the first index fastest, with 8 bytes each."""
    cells = tuple(count - 1 for count in nodes.shape[:-1])
    if values.shape != cells:
        raise InputError(f"cell array {name!r} has shape {values.shape}", f"give {cells}")
    return np.ascontiguousarray(values.T, dtype="<f8" if values.dtype.kind == "f" else "<i8")
