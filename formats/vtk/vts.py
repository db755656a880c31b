"""Writing VTK XML structured grids, ``.vts``.

Written raw appended, little endian, float64, with 64-bit lengths: the form that is quickest to write
and that every VTK reads. Topology, name, parts and provenance go into FieldData, which VTK shows and
nothing stumbles over.
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import math
import struct
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import Heights, only_one
from meshonet.formats.mesh.metadata import Facts, facts_of
from meshonet.formats.vtk.arrays import escaped, plane_points
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


def write(
    path: Path,
    grid: Grid,
    cell_data: Mapping[str, NDArray[Any]] | None = None,
    heights: Heights = (0.0,),
    *,
    block: int = 0,
    number: int = 0,
) -> None:
    """Write one block of a grid, a plane of its nodes at each of `heights`.

    `cell_data` has (ni-1, nj-1) values by name; `number` is the grid's in a set of files, by which its blocks
    know each other.
    """
    planes, nodes = len(heights), grid.blocks[block].nodes
    ni, nj = nodes.shape[:2]
    cells = {name: _cell_values(name, values, (ni - 1, nj - 1)) for name, values in (cell_data or {}).items()}
    with path.open("wb") as stream:
        stream.write(_head((ni, nj, planes), facts_of(grid, block, number), cells).encode())
        stream.write(struct.pack("<Q", 24 * planes * ni * nj))
        for height in heights:
            for points in plane_points(nodes, height, "<f8"):
                stream.write(points.data)
        for values in cells.values():
            stream.write(struct.pack("<Q", values.nbytes))
            stream.write(values.data)
        stream.write(b"\n  </AppendedData>\n</VTKFile>\n")


def write_grids(path: Path, grids: Iterable[Grid], heights: Heights = (0.0,)) -> None:
    """Write the one grid of `grids`, a plane of its nodes at each of `heights`."""
    write(path, only_one(grids, "a .vts file"), heights=heights)


def _head(dims: tuple[int, int, int], facts: Facts, cells: Mapping[str, NDArray[Any]]) -> str:
    extent = " ".join(f"0 {n - 1}" for n in dims)
    offset = 8 + 24 * math.prod(dims)
    arrays = []
    for name, values in cells.items():
        kind = "Float64" if values.dtype.kind == "f" else "Int64"
        tag = f'DataArray type="{kind}" Name="{escaped(name)}" format="appended" offset="{offset}"'
        arrays.append(f"        <{tag}/>")
        offset += 8 + values.nbytes
    cell_data = ["      <CellData>", *arrays, "      </CellData>"] if arrays else ["      <CellData/>"]
    lines = (*_field_data(facts), f'    <Piece Extent="{extent}">', "      <PointData/>", *cell_data)
    return _HEAD.format(extent=extent, lines="\n".join(lines))


def _field_data(facts: Facts) -> list[str]:
    """Return the FieldData element; VTK spells strings as signed bytes, each string ended by a zero."""
    lines = ["    <FieldData>"]
    for name, texts in facts.items():
        codes = " ".join(map(str, np.frombuffer("".join(text + "\0" for text in texts).encode(), np.int8)))
        tag = f'Array type="String" Name="{name}" NumberOfTuples="{len(texts)}" format="ascii"'
        lines.append(f"      <{tag}>{codes}</Array>")
    return [*lines, "    </FieldData>"]


def _cell_values(name: str, values: NDArray[Any], cells: tuple[int, int]) -> NDArray[Any]:
    """Return per-cell `values` as VTK lays them out: (nj-1, ni-1), i fastest, 8 bytes each."""
    if values.shape != cells:
        raise InputError(f"cell array {name!r} has shape {values.shape}", f"give {cells}")
    return np.ascontiguousarray(values.T, dtype="<f8" if values.dtype.kind == "f" else "<i8")
