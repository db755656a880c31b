"""Reading neutral map files (`meshonet.formats.plot3d.nmf`): what faces are, and what joins them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from meshonet.formats.mesh.windows import Face, Pair, Window
from meshonet.formats.plot3d.nmf import FACES, PART
from meshonet.formats.source import printable
from meshonet.geometry.blocks.patches import Kind, kind_of
from meshonet.geometry.errors import InputError

_KINDS: tuple[tuple[str, Kind], ...] = (
    ("viscous", "wall"), ("wall", "wall"), ("tangency", "wall"), ("inviscid", "wall"), ("farfield",
    "farfield"), ("inflow", "inlet"), ("outflow", "outlet"), ("back_pressure", "outlet"), ("sym", "symmetry"),
)  # fmt: skip
_NOTHING = ("unprocessed", "collapsed", "pole", "patched", "overset")
_MOST_BYTES = 1 << 26
_REMEDY = "write the map again, or take it away"


class Map(NamedTuple):
    """What a map says."""

    faces: list[Face]
    pairs: list[Pair]


def read_map(path: Path, dims: Sequence[tuple[int, int, int]]) -> Map:
    """Return what the map at `path` says of blocks with `dims`.

    Raises InputError: it cannot be read, or is of blocks of other sizes.
    """
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
    said = [tuple(int(word) for word in line.split()[1:4]) for _, line in plain[1 : count + 1]]
    if said != [tuple(size) for size in dims]:
        shown = ", ".join("x".join(map(str, size)) for size in said[:3])
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
    """Add what one row says: a face, or two that are joined."""
    words = line.split()
    title = words[0].strip("'\"")
    numbers = [int(word) for word in words[1:13] if word.lstrip("-").isdigit()]
    windows = [_window(numbers[k : k + 6], dims) for k in range(0, len(numbers), 6)]
    if title.lower().startswith(_NOTHING):
        return
    if len(windows) == 1:
        name = names[0] if names and names[0] else printable(title).lower() or "part"
        kind: Kind = next((kind for sign, kind in _KINDS if title.lower().startswith(sign)), "other")
        by_name = kind_of(name)
        known.faces.append(Face(windows[0], name, kind if by_name == "other" else by_name))
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


def _window(numbers: Sequence[int], dims: Sequence[tuple[int, int, int]]) -> Window:
    """Return the window that block, face and two ranges are; ValueError where there is no such face."""
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
    return Window(number - 1, (first[0], first[1], first[2]), (last[0], last[1], last[2]))


def _fixed(face: int) -> int:
    """Return the index that is constant on a face of this number."""
    return FACES.index(face if face % 2 else face - 1)
