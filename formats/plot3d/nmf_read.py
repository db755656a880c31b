"""Reading neutral map files (`meshonet.formats.plot3d.nmf`): the patches and interfaces of plane blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from meshonet.formats.mesh.gather import Joint, Stretch
from meshonet.formats.mesh.spans import span_of
from meshonet.formats.plot3d.nmf import FACES, PART
from meshonet.formats.source import printable
from meshonet.geometry.blocks.patches import Kind, Patch, kind_of
from meshonet.geometry.errors import InputError

_KINDS: tuple[tuple[str, Kind], ...] = (
    ("viscous", "wall"), ("wall", "wall"), ("tangency", "wall"), ("inviscid", "wall"), ("farfield",
    "farfield"), ("inflow", "inlet"), ("outflow", "outlet"), ("back_pressure", "outlet"), ("sym", "symmetry"),
)  # fmt: skip
_NOTHING = ("unprocessed", "collapsed", "pole", "patched", "overset")
_MOST_BYTES = 1 << 26


@dataclass(frozen=True)
class Map:
    """What a map says of plane blocks: each one's patches, and the joints."""

    patches: tuple[list[Patch], ...]
    joints: list[Joint] = field(default_factory=list)


def read_map(path: Path, dims: Sequence[tuple[int, int, int]], dropped: Sequence[int]) -> Map:
    """Return what the map at `path` says of blocks with `dims`, of which index `dropped` is not in the plane.

    Raises InputError: it cannot be read, or is of blocks of other sizes.
    """
    name = printable(path.name)
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise InputError(f"its map {name} is implausibly large", "take it away")
        text = path.read_text("utf-8", "replace")
        lines = list(enumerate((line.strip() for line in text.splitlines()), start=1))
        return _read([(n, line) for n, line in lines if line], dims, dropped)
    except InputError as error:
        error.place = error.place or name
        raise
    except (ValueError, IndexError, OSError) as error:
        raise InputError(
            f"its map cannot be read ({printable(str(error))[:80]})", _REMEDY, place=name
        ) from None


_REMEDY = "write the map again, or take it away"


def _read(lines: list[tuple[int, str]], dims: Sequence[tuple[int, int, int]], dropped: Sequence[int]) -> Map:
    plain = [(n, line) for n, line in lines if not line.startswith("#")]
    count = int(plain[0][1].split()[0]) if plain else 0
    said = [tuple(int(word) for word in line.split()[1:4]) for _, line in plain[1 : count + 1]]
    if said != [tuple(size) for size in dims]:
        shown = ", ".join("x".join(map(str, size)) for size in said[:3])
        raise InputError(f"its map is of {count} blocks: {shown}", _REMEDY)
    found = Map(tuple([] for _ in dims))
    rows = {n for n, _ in plain[count + 1 :]}
    names: list[str] = []
    for number, line in lines:
        if number in rows:
            try:
                _row(found, line, names, dims, dropped)
            except (ValueError, IndexError):
                raise InputError(f"row {printable(line)[:60]!r} is not understood", _REMEDY) from None
            names = []
        elif line.startswith(PART.strip()):
            names.append(printable(line[len(PART.strip()) :].strip()))
    return found


def _row(
    found: Map, line: str, names: list[str], dims: Sequence[tuple[int, int, int]], dropped: Sequence[int]
) -> None:
    """Add what one row says: a patch, or two stretches that are joined."""
    words = line.split()
    title = words[0].strip("'\"")
    numbers = [int(word) for word in words[1:13] if word.lstrip("-").isdigit()]
    ends = [_stretch(numbers[k : k + 6], dims, dropped) for k in range(0, len(numbers), 6)]
    if any(end is None for end in ends) or title.lower().startswith(_NOTHING):
        return
    own, *donor = (end for end in ends if end is not None)
    if donor:
        periodic = title.lower().startswith("periodic")
        for (block, *span), name in zip(
            (own, *donor), names or ([title.lower()] if periodic else []), strict=False
        ):
            found.patches[block].append(Patch(name, *span))  # type: ignore[arg-type]
        found.joints.append(Joint(own, donor[0]))
        return
    name = names[0] if names and names[0] else printable(title).lower() or "part"
    kind = next((kind for sign, kind in _KINDS if title.lower().startswith(sign)), kind_of(name))
    told = kind_of(name)
    block, side, first, last = own
    found.patches[block].append(Patch(name, side, first, last, kind=kind if told == "other" else told))


def _stretch(
    numbers: Sequence[int], dims: Sequence[tuple[int, int, int]], dropped: Sequence[int]
) -> Stretch | None:
    """Return the stretch of a plane block that block, face and two ranges are, None for its two planes."""
    number, face, *spans = numbers
    block = number - 1
    if not 0 <= block < len(dims):
        raise ValueError(number)
    fixed = FACES.index(face if face % 2 else face - 1)
    corners = np.empty((2, 3), np.int64)
    corners[:, fixed] = 1 if face % 2 else dims[block][fixed]
    corners[:, (fixed + 1) % 3], corners[:, (fixed + 2) % 3] = spans[:2], spans[2:4]
    counts = tuple(n for axis, n in enumerate(dims[block]) if axis != dropped[block])
    span = span_of(corners, counts, dropped[block]) if fixed != dropped[block] else None
    return (block, *span) if span else None
