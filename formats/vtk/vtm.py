"""VTK multi-block files, ``.vtm``: an index beside a folder ``NAME_blocks`` with a ``.vts`` for every grid.

https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path, PurePosixPath

from meshonet.formats.format import Heights
from meshonet.formats.output import final_name, whole_folder
from meshonet.formats.source import Source, printable
from meshonet.formats.vtk.arrays import escaped
from meshonet.formats.vtk.vts import write
from meshonet.formats.vtk.vts_read import read_grids as read_block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_MOST_BYTES = 16 << 20
_OURS = re.compile(r"block-\d+\.vts")


def write_grids(path: Path, grids: Iterable[Grid], heights: Heights = (0.0,)) -> None:
    """Write every grid of `grids`, a plane of its nodes at each of `heights`.

    Raises InputError: there is no grid; the folder of the blocks holds something else, which would be lost.
    """
    folder = path.with_name(f"{Path(final_name(path)).stem}_blocks")
    if folder.is_dir() and not all(_OURS.fullmatch(entry.name) for entry in folder.iterdir()):
        shown = printable(str(folder.name))
        raise InputError(f"folder {shown} holds other files, which would be lost", "choose another name")
    lines = []
    with whole_folder(folder) as part:
        for k, grid in enumerate(grids):
            write(part / f"block-{k}.vts", grid, heights=heights)
            title = escaped(grid.name or f"block-{k}")
            lines.append(
                f'    <DataSet index="{k}" name="{title}" file="{escaped(folder.name)}/block-{k}.vts"/>'
            )
        if not lines:
            raise InputError("there is no grid to write", "check the input")
    tag = '<VTKFile type="vtkMultiBlockDataSet" version="1.0" byte_order="LittleEndian">'
    head = ['<?xml version="1.0"?>', tag, "  <vtkMultiBlockDataSet>"]
    index = [*head, *lines, "  </vtkMultiBlockDataSet>", "</VTKFile>", ""]
    path.write_text("\n".join(index), encoding="utf-8")


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grid of every ``.vts`` that the index names, in its folder or below.

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
    for block in root.iter("DataSet"):
        if block.get("file"):
            yield from _block(source.path.parent, block.get("file", ""), block.get("name", ""))


def _block(folder: Path, name: str, title: str) -> Iterator[Grid]:
    shown = printable(name)[:60]
    parts = PurePosixPath(name)
    if parts.is_absolute() or ".." in parts.parts or "\0" in name:
        raise InputError(f"names {shown!r}, which is not below its folder", "keep the blocks beside it")
    if parts.suffix.lower() != ".vts":
        raise InputError(f"names {shown!r}, which is no .vts", "give blocks that are structured grids")
    path = folder / parts
    if not path.is_file():
        raise InputError(f"names {shown!r}, which is not there", "keep the blocks beside it")
    try:
        for grid in read_block(Source(printable(str(path)), path=path)):
            yield replace(grid, name=printable(title)) if title and grid.name == path.stem else grid
    except InputError as error:
        error.place = error.place or shown
        raise
