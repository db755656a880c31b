"""Named stretches of a boundary: what a flow solver calls patches, markers or boundary conditions."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats, Side, Topology
from meshonet.geometry.errors import InputError


@dataclass(frozen=True)
class Patch:
    """Nodes ``start`` to ``stop`` (both included) of one side, under a name.

    South and north count nodes along i, west and east along j.
    """

    name: str
    side: Side
    start: int
    stop: int


def default_patches(topology: Topology, ni: int, nj: int) -> tuple[Patch, ...]:
    """Return the parts that a grid of `topology` has when nobody named them.

    ``quad`` has its four sides, ``o`` a wall and a far field (its west and east are the seam). Where the wake
    of a ``c`` ends its nodes tell (`known_patches`): here it is all wall.

    Examples
    --------
    >>> [part.name for part in default_patches("o", 5, 4)]
    ['wall', 'farfield']
    """
    last = {"south": ni - 1, "north": ni - 1, "west": nj - 1, "east": nj - 1}
    if topology == "quad":
        return tuple(Patch(side, side, 0, last[side]) for side in SIDES)
    parts = (Patch("wall", "south", 0, ni - 1), Patch("farfield", "north", 0, ni - 1))
    if topology == "o":
        return parts
    return (*parts, Patch("farfield", "east", 0, nj - 1), Patch("farfield", "west", 0, nj - 1))


def wake_nodes(south: Floats) -> int:
    """Return how many nodes at the start of `south` (ni, 2) are met again, in reverse, at its end."""
    half = south[: len(south) // 2]
    differs = (half != south[::-1][: len(half)]).any(axis=1)
    return int(np.argmax(differs)) if differs.any() else 0


def c_patches(ni: int, nj: int, wake: int) -> tuple[Patch, ...]:
    """Return the named parts of a C grid whose wake has `wake` nodes."""
    return (
        Patch("wake", "south", 0, wake - 1),
        Patch("wall", "south", wake - 1, ni - wake),
        Patch("wake", "south", ni - wake, ni - 1),
        Patch("farfield", "north", 0, ni - 1),
        Patch("farfield", "east", 0, nj - 1),
        Patch("farfield", "west", 0, nj - 1),
    )


def known_patches(topology: Topology, south: Floats, nj: int) -> tuple[Patch, ...]:
    """Return the parts of a grid whose south side is `south` (ni, 2) when nobody named them."""
    wake = wake_nodes(south) if topology == "c" else 0
    return c_patches(len(south), nj, wake) if wake > 1 else default_patches(topology, len(south), nj)


def check_patches(parts: Iterable[Patch], ni: int, nj: int) -> None:
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
