"""NASA's neutral map file, ``.nmf``: boundary conditions and connections of Plot3D blocks.

Patch names are comments above rows; periodic sides, which it lacks, are rows of type PERIODIC.
https://crumsey.github.io/turbmodels/nmf_documentation.html
"""

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

from meshonet.formats.format import only_one
from meshonet.formats.mesh.names import kind_said, kinds, words
from meshonet.formats.mesh.periodic import donor_range, patch_on
from meshonet.formats.mesh.windows import Face, FaceWindow, Pair
from meshonet.formats.source import printable
from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES, Range
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind, kind_of
from meshonet.geometry.errors import InputError

PART = "# part: "  # start of a comment with the patch name of the next row, or of both sides of a connection
FACES = (3, 5, 1)  # number of the face where each index is 1; the next number is the face where it is largest
_TYPES: dict[Kind, str] = {
    "wall": "VISCOUS", "farfield": "FARFIELD", "inlet": "INFLOW", "outlet": "OUTFLOW", "symmetry": "SYMMETRY",
}  # fmt: skip
"""Boundary types of the map; other patches have their name as type."""
_RULE = "# " + "=" * 78


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the neutral map file (patches and connections) of the only grid of `grids`."""
    write_map(path, [only_one(grids, "a .nmf file")])


def write_map(path: Path, grids: Sequence[Grid], span: int = 2) -> None:
    """Write the neutral map of all blocks. With `span` 0, 1 or 2, direction k is I, J or K of the file."""
    dims: list[list[int]] = []
    rows: list[str] = []
    for grid in grids:
        before = len(dims)
        for block in grid.blocks:
            counts = [*block.counts, 1][:3]
            counts.insert(span, counts.pop())
            dims.append(counts)
        rows += _Rows(grid, before, span).all()
    heads = [f"{k} {' '.join(map(str, counts))}" for k, counts in enumerate(dims, start=1)]
    text = [_RULE, "# Block# IDIM JDIM KDIM", _RULE, str(len(dims)), *heads, _RULE]
    text += ["# Type B1 F1 S1 E1 S2 E2 [B2 F2 S1 E1 S2 E2 Swap]", _RULE, *rows, ""]
    path.write_text("\n".join(text), encoding="utf-8")


class _Rows:
    """The rows of one grid, whose first block has the number `before` + 1."""

    def __init__(self, grid: Grid, before: int, span: int) -> None:
        self._grid, self._before = grid, before
        self._axes = [axis for axis in range(3) if axis != span] + [span]
        """The index of the file that each direction is."""

    def all(self) -> list[str]:
        """Return the rows of patches and of connections."""
        grid, rows = self._grid, []
        patches = grid.outer_patches()
        kind, word = kinds(grid, patches), words(patch.name for patch in patches)
        for p in patches:
            rows.append(f"{PART}{p.name}")
            part = p.range(grid.blocks[p.block].face(p.side).shape[:-1])
            where, _ = self._window(p.block, p.side, part)
            rows.append(f"{_TYPES.get(kind[p.name], word[p.name])} {where}")
        for connection in grid.connections:
            rows += self._joined(connection)
        return rows

    def _joined(self, each: Connection) -> list[str]:
        own, own_first = self._window(each.block, each.side, each.range)
        donor, donor_first = self._window(each.donor, each.donor_side, donor_range(each))
        # the third direction of blocks with two lies along that of others
        partner = [*(abs(way) - 1 for way in each.orientation), 1][own_first]
        swap = str(partner != donor_first).upper()
        if each.transform is None:
            return [f"ONE_TO_ONE {own} {donor} {swap}"]
        names = [patch_on(self._grid, way) for way in (each, each.reversed())]
        return [*(f"{PART}{name}" for name in names if all(names)), f"PERIODIC {own} {donor} {swap}"]

    def _window(self, block: int, side: Side, part: Range) -> tuple[str, int]:
        """Return block, face and ranges of a side part, and the direction of the first range.

        Ranges run along the two indices that follow that of the face in cyclic order.
        """
        fixed, end = PLACES[side]
        axis = self._axes[fixed]
        spans = [f"{first + 1} {last + 1}" for first, last in part]
        along = [self._axes[direction] for direction in range(3) if direction != fixed]
        spans += ["1 1"] * (2 - len(spans))
        first = along.index((axis + 1) % 3)
        return f"{self._before + block + 1} {FACES[axis] - end} {spans[first]} {spans[1 - first]}", first


_KINDS: tuple[tuple[str, Kind], ...] = (
    ("viscous", "wall"), ("wall", "wall"), ("tangency", "wall"), ("inviscid", "wall"), ("farfield",
    "farfield"), ("inflow", "inlet"), ("outflow", "outlet"), ("back_pressure", "outlet"), ("sym", "symmetry"),
)  # fmt: skip
"""Kinds of boundary by the first letters of the map's types."""
_NOTHING = ("unprocessed", "collapsed", "pole", "patched", "overset")
"""Row types without information about a face that is used here."""
_MOST_BYTES = 1 << 26  # largest file that is read; a larger one would have a million rows
_REMEDY = "write the map again, or take it away"  # remedy for a map that does not match its grid


class Map(NamedTuple):
    """Content of a neutral map: named faces, and pairs of connected faces."""

    faces: list[Face]
    pairs: list[Pair]


def read_map(path: Path, dims: Sequence[tuple[int, int, int]]) -> Map:
    """Return faces and connections from a map file. Raises InputError: other node counts than `dims`."""
    name = printable(path.name)
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"its map {name} is implausibly large", "take it away")
        text = path.read_text("utf-8", "replace")
        lines = list(enumerate((line.strip() for line in text.splitlines()), start=1))
        return _read([(n, line) for n, line in lines if line], dims)
    except InputError as error:
        error.place = error.place or name
        raise
    except (ValueError, IndexError, OSError) as error:
        raise InputError(
            f"its map cannot be read ({printable(str(error))[:80]})", _REMEDY, place=name
        ) from None


def _read(lines: list[tuple[int, str]], dims: Sequence[tuple[int, int, int]]) -> Map:
    plain = [(n, line) for n, line in lines if not line.startswith("#")]
    count = int(plain[0][1].split()[0]) if plain else 0
    own_dims = [tuple(int(word) for word in line.split()[1:4]) for _, line in plain[1 : count + 1]]
    if own_dims != [tuple(size) for size in dims]:
        shown = ", ".join("x".join(map(str, size)) for size in own_dims[:3])
        raise InputError(f"its map is of {count} blocks: {shown}", _REMEDY)
    known = Map([], [])
    rows = {n for n, _ in plain[count + 1 :]}
    names: list[str] = []
    for number, line in lines:
        if number in rows:
            try:
                _row(known, line, names, dims)
            except (ValueError, IndexError):
                raise InputError(f"row {printable(line)[:60]!r} is not understood", _REMEDY) from None
            names = []
        elif line.startswith(PART.strip()):
            names.append(printable(line[len(PART.strip()) :].strip()))
    return known


def _row(known: Map, line: str, names: list[str], dims: Sequence[tuple[int, int, int]]) -> None:
    """Add the face or the connected pair of a row."""
    words = line.split()
    title = words[0].strip("'\"")
    numbers = [int(word) for word in words[1:13] if word.lstrip("-").isdigit()]
    windows = [_window(numbers[k : k + 6], dims) for k in range(0, len(numbers), 6)]
    if title.lower().startswith(_NOTHING):
        return
    if len(windows) == 1:
        name = names[0] if names and names[0] else printable(title).lower() or "part"
        known.faces.append(Face(windows[0], name, kind_said(name, title.lower(), _KINDS)))
        return
    own, donor = windows
    periodic = title.lower().startswith("periodic")
    names = names or ([title.lower()] if periodic else [])
    known.faces.extend(Face(w, name, kind_of(name)) for w, name in zip(windows, names, strict=False))
    first, second = ((_fixed(numbers[at]) + 1) % 3 for at in (1, 7))
    swapped = any(word.strip(".").lower() in ("true", "t") for word in words[13:14])
    partner = [0, 0, 0]
    partner[_fixed(numbers[1])] = _fixed(numbers[7])
    for step in (0, 1):
        partner[(first + step) % 3] = (second + (step ^ swapped)) % 3
    known.pairs.append(Pair(own, donor, (partner[0], partner[1], partner[2])))


def _window(numbers: Sequence[int], dims: Sequence[tuple[int, int, int]]) -> FaceWindow:
    """Return the window of block, face and two ranges. Raises ValueError: no such face."""
    number, face, *spans = numbers
    fixed = _fixed(face)
    if not 1 <= number <= len(dims) or len(spans) != 4:
        raise ValueError(number)
    first, last = [0, 0, 0], [0, 0, 0]
    first[fixed] = last[fixed] = 0 if face % 2 else dims[number - 1][fixed] - 1
    for step in (1, 2):
        axis = (fixed + step) % 3
        first[axis], last[axis] = (node - 1 for node in spans[2 * step - 2 : 2 * step])
        if not 0 <= min(first[axis], last[axis]) <= max(first[axis], last[axis]) < dims[number - 1][axis]:
            raise ValueError(face)
    return FaceWindow(number - 1, (first[0], first[1], first[2]), (last[0], last[1], last[2]))


def _fixed(face: int) -> int:
    """Return the index that is constant on a face with this number."""
    return FACES.index(face if face % 2 else face - 1)
