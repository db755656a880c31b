"""VTK multi-block files, ``.vtm``: an index beside a folder ``NAME_blocks`` with a ``.vts`` for every block.

A grid of several blocks is a ``Block`` in the index, and its blocks say which grid they belong to; a grid of
one block stands there by itself and says that it is whole. Blocks that say neither are another's: those that
touch make one grid. https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import count, groupby
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple, TypeAlias

from numpy.typing import NDArray

from meshonet.formats.mesh.metadata import (
    Facts,
    facts_of,
    grid_of_blocks,
    grid_with,
    nodes_by_facts,
    number_of_grid,
)
from meshonet.formats.mesh.recover_topology import usable
from meshonet.formats.mesh.structured import FileBlock, grids_of_file
from meshonet.formats.output import final_name, whole_folder
from meshonet.formats.source import Source, printable
from meshonet.formats.vtk.arrays import escaped
from meshonet.formats.vtk.vts import write
from meshonet.formats.vtk.vts_read import read_block
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.extrude import plane_of_extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, in_place

CellData: TypeAlias = Callable[[Grid], Sequence[Mapping[str, NDArray[Any]]]]
"""Gives values of the cells of each block of a grid, by name (`meshonet.formats.vtk.vts.write`)."""
_MOST_BYTES = 16 << 20
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


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grids that the ``.vts`` make which the index names, in its folder or below.

    Raises InputError: no such index; a file that is not below its folder, is missing or no ``.vts``.
    """
    from xml.etree import ElementTree

    if source.path is None:
        raise InputError("names files beside itself, and a stream has none", "give its path")
    if source.size > _MOST_BYTES:
        raise InputError(f"{source.size >> 20} MB are too much for an index", "give a .vtm file")
    try:
        root = ElementTree.fromstring(source.read_bytes())  # noqa: S314  (expat bounds what entities expand to)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise InputError(f"is not well-formed XML ({printable(str(error))[:80]})", "write it again") from None
    if root.tag != "VTKFile" or root.get("type") != "vtkMultiBlockDataSet":
        raise InputError("is no VTK multi-block file", "give one of type vtkMultiBlockDataSet")
    names = [block.get("file", "") for block in root.iter("DataSet")]
    if not any(names):
        raise InputError("names no files", "write the file again")
    blocks = (
        _read(source.path.parent, name, block.get("name", ""))
        for block in root.iter("DataSet")
        if (name := block.get("file", ""))
    )
    yield from _grids(blocks, source.stem)


class _Block(NamedTuple):
    """x, y, z (ni, nj, nk) each, what their file says of them, the name in the index, that of the file."""

    coordinates: Sequence[Floats]
    facts: Facts
    title: str
    file: str

    @property
    def name(self) -> str:
        """What to call it when its file does not say."""
        return printable(self.title or PurePosixPath(self.file).stem)

    @property
    def nodes(self) -> Floats:
        """Its nodes by what its file says of them."""
        with in_place(self.shown):
            return usable(nodes_by_facts(self.coordinates, self.facts))

    @property
    def shown(self) -> str:
        """What messages call it."""
        return printable(self.file)[:60]


def _grids(blocks: Iterator[_Block], stem: str) -> Iterator[Grid]:
    """Yield the grids that this package wrote, then those that the blocks of others make."""
    foreign: list[_Block] = []

    def kind(block: _Block) -> object:
        number = number_of_grid(block.facts)
        return bool(block.facts.get("topology")) if number is None else f"grid {number}"

    for which, group in groupby(blocks, key=kind):
        if isinstance(which, str):
            yield grid_of_blocks([(block.nodes, block.facts) for block in group], stem)
        elif which:
            for block in group:
                yield grid_with(block.nodes, block.facts, block.name)
        else:
            foreign += group
    read = [FileBlock(block.coordinates, block.name, block.shown) for block in foreign]
    yield from grids_of_file(read, (), (), read[0].name if len(read) == 1 else stem)


def _read(folder: Path, name: str, title: str) -> _Block:
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
        return _Block(*read_block(Source(printable(str(path)), path=path)), title, name)
