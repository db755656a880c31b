"""SU2 meshes, ``.su2``: text with 17 digits, merged seams, one marker per patch, nodes from 0.

Periodic motions belong into the configuration file; the mesh has them as comments to copy there.
https://su2code.github.io/docs_v7/Mesh-File/
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

import numpy as np

from meshonet.formats.format import only_one
from meshonet.formats.mesh.collapsed import refuse_collapsed
from meshonet.formats.mesh.names import words
from meshonet.formats.mesh.surface import MeshBoundary, shapes_of
from meshonet.formats.mesh.unstructured import Indices, Unstructured, unstructured
from meshonet.formats.source import Source, printable
from meshonet.formats.text.number_table import parsed, write_rows
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.screw import screw_of
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape

_KINDS = {2: "3", 4: "9", 8: "12"}  # VTK's numbers of lines, quadrilaterals, hexahedra, by number of nodes
_NODES = {b"3": 2, b"5": 3, b"9": 4}  # nodes of lines, triangles and quadrilaterals, by VTK's numbers
_ROUNDING = 1e-14  # relative error of an angle that comes from a rotation matrix
_CUT = "the file is cut short: write it again"  # remedy for a truncated file


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write a grid as SU2, with patches as markers. Raises InputError unless `grids` has exactly one."""
    grid = only_one(grids, "a .su2 file")
    refuse_collapsed(grid, "a .su2 file")
    mesh = unstructured(grid)
    points, markers, cells = mesh.points, mesh.faces, mesh.cells
    word = words(markers)
    with path.open("wb") as stream:
        stream.write(_periodic(mesh, word).encode("ascii"))
        stream.write(f"NDIME= {points.shape[1]}\nNELEM= {len(cells)}\n".encode("ascii"))
        _write_cells(stream, cells)
        stream.write(f"NPOIN= {len(points)}\n".encode("ascii"))
        write_rows(stream, " ".join(["%e"] * points.shape[1]), points)
        stream.write(f"NMARK= {len(markers)}\n".encode("ascii"))
        for name, faces in markers.items():
            stream.write(f"MARKER_TAG= {word[name]}\nMARKER_ELEMS= {len(faces)}\n".encode("ascii"))
            _write_cells(stream, faces)


def _periodic(mesh: Unstructured, word: Mapping[str, str]) -> str:
    """Return as comments the lines that couple periodic markers: names, centre, degrees, shift."""
    if not mesh.periodic:
        return ""
    pairs = []
    for pair in mesh.periodic:
        screw = screw_of(pair.motion)
        numbers = *screw.centre, *map(_degrees, screw.angles.tolist()), *screw.shift
        listed = ", ".join(f"{number + 0.0:.17g}" for number in numbers)
        pairs.append(f"{word[pair.name]}, {word[pair.partner]}, {listed}")
    return f"% The configuration file needs this line:\n% MARKER_PERIODIC= ( {', '.join(pairs)} )\n"


def _degrees(angle: float) -> float:
    """Return an angle in degrees, exact if it is a whole part of the turn to rounding."""
    value = math.degrees(angle)
    parts = round(360.0 / value) if abs(value) > _ROUNDING else 0
    return 360.0 / parts if parts and abs(360.0 / parts - value) <= _ROUNDING * abs(value) else value


def _write_cells(stream: BinaryIO, nodes: Indices) -> None:
    count = nodes.shape[1]
    write_rows(stream, " ".join([_KINDS[count], *["%d"] * count]), nodes)


def read_shapes(source: Source) -> Iterator[Shape]:
    """Yield the shapes that the markers of an SU2 mesh enclose.

    Raises InputError if it is no SU2 mesh or not planar, or if markers are not closed curves.
    """
    yield from shapes_of(_Reader(source.read_bytes().split(b"\n")).surface(), source.stem)


class _Reader:
    """Reads the lines of a mesh, keyword by keyword."""

    def __init__(self, lines: list[bytes]) -> None:
        self._lines, self._at = lines, 0
        self._points: Floats | None = None
        self._cells: dict[int, Indices] = {}
        self._edges: dict[str, Indices] = {}
        self._tag = ""

    def surface(self) -> MeshBoundary:
        while self._at < len(self._lines):
            word = self._lines[self._at].split(b"%", 1)[0].strip()
            self._at += 1
            if not word:
                continue
            key, equals, value = word.partition(b"=")
            if not equals:
                raise self._wrong(f"{_shown(word)!r} is no KEYWORD= VALUE", "give an SU2 mesh")
            self._take(key.strip().upper(), value.strip())
        if self._points is None:
            raise InputError("has no points", _CUT)
        cells = [self._cells[nodes] for nodes in sorted(self._cells) if nodes != 2]
        return MeshBoundary(self._points, self._edges, cells)

    def _take(self, key: bytes, value: bytes) -> None:
        if key == b"NDIME" and self._count(value) != 2:
            raise self._wrong(f"is a mesh of {_shown(value)} dimensions", "give one of 2")
        if key == b"NZONE" and self._count(value) != 1:
            raise self._wrong(f"has {_shown(value)} zones", "give a mesh of one zone")
        if key == b"NELEM":
            self._cells = self._elements(self._count(value))
        elif key == b"NPOIN":
            rows = self._rows(self._count(value.split()[0] if value else b""))
            if rows.shape[1] not in (2, 3):
                raise self._wrong(
                    f"points have {rows.shape[1]} numbers", "a plane mesh has x, y and a number"
                )
            self._points = np.ascontiguousarray(rows[:, :2])
        elif key == b"MARKER_TAG":
            self._tag = printable(value.decode("utf-8", "replace"))[:200] or "part"
        elif key == b"MARKER_ELEMS":
            lines = self._elements(self._count(value)).get(2)
            if lines is not None:
                had = self._edges.get(self._tag, np.empty((0, 2), np.int64))
                self._edges[self._tag] = np.concatenate([had, lines])

    def _elements(self, count: int) -> dict[int, Indices]:
        """Return node numbers, by the number of nodes of a cell."""
        if count == 0:
            return {}
        first = self._lines[self._at].split(None, 1) if self._at < len(self._lines) else []
        kinds = {line.split(None, 1)[0] if line.strip() else b"" for line in self._ahead(count)}
        if not kinds <= set(_NODES):
            if b"" in kinds:
                raise self._wrong(f"an empty line among the next {count}, which should be cells", _CUT)
            names = ", ".join(_shown(kind) for kind in sorted(kinds - set(_NODES)))
            raise self._wrong(
                f"has cells of kind {names}"[:80], "a plane mesh has lines, triangles and quads"
            )
        if len(kinds) == 1:
            nodes = _NODES[first[0]]
            return {nodes: self._indices(self._rows(count), nodes)}
        cells: dict[int, list[Indices]] = {}
        for _ in range(count):
            nodes = _NODES[self._lines[self._at].split(None, 1)[0]]
            cells.setdefault(nodes, []).append(self._indices(self._rows(1), nodes))
        return {nodes: np.concatenate(rows) for nodes, rows in cells.items()}

    def _indices(self, rows: Floats, nodes: int) -> Indices:
        if rows.shape[1] not in (nodes + 1, nodes + 2):
            raise self._wrong(
                f"cells have {rows.shape[1]} numbers", f"write kind, {nodes} points and a number"
            )
        if not (np.abs(rows) < 2**53).all():
            raise self._wrong("a cell names no point", "write the mesh again")
        return rows[:, 1 : nodes + 1].astype(np.int64)

    def _ahead(self, count: int) -> list[bytes]:
        if count > len(self._lines) - self._at:
            left = len(self._lines) - self._at
            raise self._wrong(f"should have {count} more lines and has {left}", _CUT)
        return self._lines[self._at : self._at + count]

    def _rows(self, count: int) -> Floats:
        """Return the numbers (count, m) in the next lines, which must have equally many."""
        lines = self._ahead(count)
        values = parsed(b"\n".join(lines))
        width = len(lines[0].split()) if lines else 2
        self._at += count
        if values is None or values.size != count * width or not width:
            raise self._wrong(
                "a line before this one has a word that is no number, or another count", "write it again"
            )
        return values.reshape(count, width)

    def _count(self, word: bytes) -> int:
        if not word.isdigit() or len(word) > 12:
            raise self._wrong(f"{_shown(word)!r} is no count", "write a whole number")
        return int(word)

    def _wrong(self, problem: str, remedy: str) -> InputError:
        return InputError(problem, remedy, place=f"line {self._at}")


def _shown(word: bytes) -> str:
    return printable(word[:40].decode("utf-8", "replace"))
