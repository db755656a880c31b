"""Named stretches of a boundary: what a flow solver calls patches, markers or boundary conditions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from geometry.arrays import SIDES, Side, Topology
from geometry.errors import InputError


@dataclass(frozen=True)
class Part:
    """Nodes ``start`` to ``stop`` (both included) of one side, under a name.

    South and north count nodes along i, west and east along j.
    """

    name: str
    side: Side
    start: int
    stop: int


def default_parts(topology: Topology, ni: int, nj: int) -> tuple[Part, ...]:
    """Return the parts that a grid of `topology` has when nobody named them.

    ``quad`` has its four sides, ``o`` a wall and a far field (its west and east are the seam). A ``c``
    grid is named by who made it, since only they know where the wake ends: here it is all wall.

    Examples
    --------
    >>> [part.name for part in default_parts("o", 5, 4)]
    ['wall', 'farfield']
    """
    last = {"south": ni - 1, "north": ni - 1, "west": nj - 1, "east": nj - 1}
    if topology == "quad":
        return tuple(Part(side, side, 0, last[side]) for side in SIDES)
    parts = (Part("wall", "south", 0, ni - 1), Part("farfield", "north", 0, ni - 1))
    if topology == "o":
        return parts
    return (*parts, Part("farfield", "east", 0, nj - 1), Part("farfield", "west", 0, nj - 1))


def check_parts(parts: Iterable[Part], ni: int, nj: int) -> None:
    """Raise InputError when a part has no name, an unknown side or leaves its side."""
    for part in parts:
        count = ni if part.side in ("south", "north") else nj
        if not part.name or part.side not in SIDES:
            raise InputError(
                f"part {part.name!r} on side {part.side!r} is not usable",
                "name it and use " + "/".join(SIDES),
            )
        if not 0 <= part.start < part.stop < count:
            raise InputError(
                f"part {part.name!r} runs from node {part.start} to {part.stop} of a side with {count} nodes",
                "keep it inside the side and at least one cell long",
            )
