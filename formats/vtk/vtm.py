"""VTK multi-block files, ``.vtm``: an index, and a folder ``NAME_blocks`` with one ``.vts`` file per block.

A ``Block`` of the index is a multi-block grid. Blocks of other programs form one grid if they touch.
https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain, count, groupby
from pathlib import Path, PurePosixPath
from typing import Any, TypeAlias

from numpy.typing import NDArray

from meshonet.formats.format import at_least_one
from meshonet.formats.mesh.metadata import facts_of
from meshonet.formats.mesh.structured import FileBlock, described_grids, grids_of_file
from meshonet.formats.output import final_name, whole_folder
from meshonet.formats.source import Source, printable
from meshonet.formats.vtk import escaped
from meshonet.formats.vtk.vts import write
from meshonet.formats.vtk.vts_read import read_block, vtk_root
from meshonet.geometry.blocks.extrude import plane_of_extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, in_place

CellData: TypeAlias = Callable[[Grid], Sequence[Mapping[str, NDArray[Any]]]]
"""Function from a grid to cell values of each block, by name (`meshonet.formats.vtk.vts.write`)."""
_OURS = re.compile(r"block-\d+\.vts")  # names of the files that this package writes into the folder


def write_grids(path: Path, grids: Iterable[Grid], cell_data: CellData | None = None) -> None:
    """Write grids as ``.vtm``, with optional cell data; the blocks are files in a folder next to it.

    Raises InputError if there is no grid, or if this folder contains other files.
    """
    folder = path.with_name(f"{Path(final_name(path)).stem}_blocks")
    if folder.is_dir() and not all(_OURS.fullmatch(entry.name) for entry in folder.iterdir()):
        shown = printable(str(folder.name))
        raise InputError(f"folder {shown} holds other files, which would be lost", "choose another name")
    lines: list[str] = []
    files = count()
    rest = iter(grids)
    first = at_least_one(rest)
    with whole_folder(folder) as part:
        for number, grid in enumerate(chain([first], rest)):
            described = plane_of_extruded(grid) or grid
            several = described.topology == "blocks"
            title = escaped(grid.name or f"block-{number}")
            if several:
                lines.append(f'    <Block index="{number}" name="{title}">')
            values = cell_data(grid) if cell_data else [{}] * len(grid.blocks)
            for block in range(len(grid.blocks)):
                name = f"block-{next(files)}.vts"
                facts = facts_of(grid, block, number)
                write(part / name, grid, values[block], facts=facts, block=block)
                place = f'index="{block if several else number}"'
                label = f"block-{block}" if several else title
                file = f"{escaped(folder.name)}/{name}"
                lines.append(f'    <DataSet {place} name="{label}" file="{file}"/>')
            if several:
                lines.append("    </Block>")
    tag = '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">'
    head = ['<?xml version="1.0"?>', tag, "  <vtkMultiBlockDataSet>"]
    index = [*head, *lines, "  </vtkMultiBlockDataSet>", "</VTKFile>", ""]
    path.write_text("\n".join(index), encoding="utf-8")


_MOST_BYTES = 16 << 20  # largest index that is read; a larger one would list some hundred thousand blocks


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grids in the ``.vts`` files that a ``.vtm`` index lists; they must be in its folder or below.

    Raises InputError if it is no such index, or if a file is elsewhere, missing or not ``.vts``.
    """
    if source.path is None:
        raise InputError("names files beside itself, and a stream has none", "give its path")
    root = vtk_root(source.bytes_below(_MOST_BYTES, "an index"), "vtkMultiBlockDataSet")
    names = [block.get("file", "") for block in root.iter("DataSet")]
    if not any(names):
        raise InputError("names no files", "write the file again")
    blocks = (
        _read(source.path.parent, name, block.get("name", ""))
        for block in root.iter("DataSet")
        if (name := block.get("file", ""))
    )
    yield from _grids(blocks, source.stem)


def _grids(blocks: Iterator[FileBlock], stem: str) -> Iterator[Grid]:
    """Yield the grids written by this package, then those formed by blocks of other programs."""
    foreign: list[FileBlock] = []
    for own, group in groupby(blocks, key=lambda block: bool(block.facts.get("topology"))):
        if own:
            yield from described_grids(group, stem)
        else:
            foreign += group
    yield from grids_of_file(foreign, (), (), foreign[0].name if len(foreign) == 1 else stem)


def _read(folder: Path, name: str, title: str) -> FileBlock:
    shown = printable(name)[:60]
    parts = PurePosixPath(name)
    if parts.is_absolute() or ".." in parts.parts or "\0" in name:
        raise InputError(f"names {shown!r}, which is not below its folder", "keep the blocks beside it")
    if parts.suffix.lower() != ".vts":
        raise InputError(f"names {shown!r}, which is no .vts", "give blocks that are structured grids")
    path = folder / parts
    if not path.is_file():
        raise InputError(f"names {shown!r}, which is not there", "keep the blocks beside it")
    with in_place(shown):
        coordinates, facts = read_block(Source(printable(str(path)), path=path))
        return FileBlock(coordinates, printable(title or parts.stem), shown, facts=facts)
