"""Reading VTK multi-block files, ``.vtm``: the index, and which grid each block belongs to.

Blocks that this package wrote say it (`meshonet.formats.vtk.vtm`). Those of others do not: where they touch
they make one grid.
"""

from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from meshonet.formats.mesh.metadata import Facts, grid_of_blocks, grid_with, nodes_by_facts, number_of_grid
from meshonet.formats.mesh.recover_topology import usable
from meshonet.formats.mesh.structured import FileBlock, grids_of_file
from meshonet.formats.source import Source, printable
from meshonet.formats.vtk.vts_read import read_block
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, in_place

_MOST_BYTES = 16 << 20


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
