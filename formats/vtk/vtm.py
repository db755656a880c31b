"""Writing VTK multi-block files, ``.vtm``: an index beside a folder ``NAME_blocks`` with a ``.vts`` a block.

A grid of several blocks is a ``Block`` in the index, and its blocks say which grid they belong to; a grid of
one block stands there by itself and says that it is whole.
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import count
from pathlib import Path
from typing import Any, TypeAlias

from numpy.typing import NDArray

from meshonet.formats.mesh.metadata import facts_of
from meshonet.formats.output import final_name, whole_folder
from meshonet.formats.source import printable
from meshonet.formats.vtk.arrays import escaped
from meshonet.formats.vtk.vts import write
from meshonet.geometry.blocks.extrude import plane_of_extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

CellData: TypeAlias = Callable[[Grid], Sequence[Mapping[str, NDArray[Any]]]]
"""Gives values of the cells of each block of a grid, by name (`meshonet.formats.vtk.vts.write`)."""
_OURS = re.compile(r"block-\d+\.vts")


def write_grids(path: Path, grids: Iterable[Grid], cell_data: CellData | None = None) -> None:
    """Write every grid of `grids`, with data of its cells.

    Raises InputError: there is no grid; the folder of the blocks holds something else, which would be lost.
    """
    folder = path.with_name(f"{Path(final_name(path)).stem}_blocks")
    if folder.is_dir() and not all(_OURS.fullmatch(entry.name) for entry in folder.iterdir()):
        shown = printable(str(folder.name))
        raise InputError(f"folder {shown} holds other files, which would be lost", "choose another name")
    lines: list[str] = []
    files = count()
    with whole_folder(folder) as part:
        for number, grid in enumerate(grids):
            described = plane_of_extruded(grid) or grid
            several = described.topology == "blocks"
            title = escaped(grid.name or f"block-{number}")
            if several:
                lines.append(f'    <Block index="{number}" name="{title}">')
            values = cell_data(grid) if cell_data else [{}] * len(grid.blocks)
            for block in range(len(grid.blocks)):
                name = f"block-{next(files)}.vts"
                facts = facts_of(described, block, number)
                write(part / name, grid, values[block], facts=facts, block=block)
                place = f'index="{block if several else number}"'
                label = f"block-{block}" if several else title
                file = f"{escaped(folder.name)}/{name}"
                lines.append(f'    <DataSet {place} name="{label}" file="{file}"/>')
            if several:
                lines.append("    </Block>")
        if not lines:
            raise InputError("there is no grid to write", "check the input")
    tag = '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">'
    head = ['<?xml version="1.0"?>', tag, "  <vtkMultiBlockDataSet>"]
    index = [*head, *lines, "  </vtkMultiBlockDataSet>", "</VTKFile>", ""]
    path.write_text("\n".join(index), encoding="utf-8")
