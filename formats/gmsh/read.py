"""The boundary of Gmsh meshes, ``.msh`` 2.2 and 4.1: their lines, or the free edges of their cells.

https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

import re
from collections.abc import Iterator

import numpy as np

from meshonet.formats.gmsh.sections import Elements, NumberedNodes, elements, nodes, physical_tags
from meshonet.formats.mesh.surface import MeshBoundary, flat, shapes_of
from meshonet.formats.mesh.unstructured import Indices
from meshonet.formats.source import Source, printable, reason_of
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape

_VERSIONS = ("2.2", "4.1")  # versions of the format that are read
_NAME = re.compile(rb'\s*(\d+)\s+(\d+)\s+"([^"\n]*)"')  # a line of ``$PhysicalNames``: dimension, tag, name
_LINES = {1: 2, 8: 3}  # nodes of Gmsh's kinds of lines, of first and second order
_CELLS = {2: 3, 3: 4, 9: 3, 10: 4, 16: 4}
"""Corners of Gmsh's kinds of lines and plane cells; those of second order have more nodes."""
_AGAIN = "write the file again"  # remedy for a damaged file


def read_shapes(source: Source) -> Iterator[Shape]:
    """Yield the shapes that the line elements of a mesh enclose.

    Raises InputError: not a Gmsh mesh of a known version; not a planar mesh; lines that are not closed.
    """
    data = source.read_bytes()
    version, binary, order = _format(data)
    names = _names(_section(data, b"PhysicalNames", needed=False))
    tags = {}
    if version == "4.1":
        tags = physical_tags(_section(data, b"Entities", needed=False), binary, order)
    try:
        numbered = nodes(_section(data, b"Nodes"), version, binary, order)
        cells = elements(_section(data, b"Elements"), version, binary, order, tags)
    except (ValueError, OverflowError, IndexError) as error:
        raise InputError(f"cannot be read ({reason_of(error)})", _AGAIN) from None
    yield from shapes_of(_surface(numbered, cells, names), source.stem)


def _format(data: bytes) -> tuple[str, bool, str]:
    """Return version, whether it is binary, and the byte order."""
    section = _section(data, b"MeshFormat")
    words = section[:100].split(None, 3)
    version = words[0].decode("latin-1") if words else ""
    if version not in _VERSIONS or len(words) < 3:
        shown = printable(version)[:20]
        raise InputError(f"is a Gmsh mesh of version {shown!r}", "save it as version 4.1 or 2.2")
    if words[1] == b"0":
        return version, False, "<"
    mark = section.find(b"\n") + 1
    order = {b"\1\0\0\0": "<", b"\0\0\0\1": ">"}.get(section[mark : mark + 4])
    if words[1] != b"1" or words[2] != b"8" or order is None:
        raise InputError("is neither text nor binary with words of 8 bytes", _AGAIN, place="$MeshFormat")
    return version, True, order


def _section(data: bytes, name: bytes, *, needed: bool = True) -> bytes:
    """Return the text between ``$name`` and ``$Endname``."""
    start = re.search(rb"(?:^|\n)\$" + name + rb"[ \t]*\r?\n", data)
    end = data.rfind(b"$End" + name) if start else -1
    if start and end >= start.end():
        return data[start.end() : end]
    if needed or start:
        problem = f"has no section ${name.decode()}" if not start else f"${name.decode()} has no end"
        raise InputError(problem, "the file is cut short, or is no Gmsh mesh")
    return b""


def _names(section: bytes) -> dict[int, str]:
    """Return the names of physical groups of lines by their tags."""
    matches = (_NAME.match(line) for line in section.splitlines())
    return {
        int(match[2]): printable(match[3].decode("utf-8", "replace")) or "part"
        for match in matches
        if match and int(match[1]) == 1 and len(match[2]) < 18
    }


def _surface(numbered: NumberedNodes, groups: Elements, names: dict[int, str]) -> MeshBoundary:
    order = np.argsort(numbered.tags, kind="stable")
    tags = numbered.tags[order]
    if not len(tags):
        raise InputError("has no nodes", _AGAIN)
    if (tags[1:] == tags[:-1]).any():
        raise InputError("has two nodes of the same number", _AGAIN, place="$Nodes")

    def places(rows: Indices) -> Indices:
        at = np.searchsorted(tags, rows)
        if not (tags[np.minimum(at, len(tags) - 1)] == rows).all():
            raise InputError("names a node that there is none of", _AGAIN, place="$Elements")
        return order[at]

    edges: dict[str, list[Indices]] = {}
    cells: dict[int, list[Indices]] = {}
    for kind, group, rows in groups:
        at = places(rows)
        if kind in _LINES:
            ways = at if _LINES[kind] == 2 else np.concatenate([at[:, [0, 2]], at[:, [2, 1]]])
            name = names.get(group, f"part-{group}") if group else ""
            edges.setdefault(name, []).append(ways)
        elif kind in _CELLS:
            cells.setdefault(_CELLS[kind], []).append(at[:, : _CELLS[kind]])
        elif kind != 15:
            raise InputError("has cells of three dimensions", "give a mesh of two")
    return MeshBoundary(
        flat(numbered.points),
        {name: np.concatenate(pieces) for name, pieces in edges.items()},
        [np.concatenate(cells[corners]) for corners in sorted(cells)],
    )
