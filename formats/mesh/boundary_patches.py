"""The outer boundary as solvers want it: every edge in one named stretch or in the cut."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias

import numpy as np

from meshonet.geometry.arrays import SIDES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch, wake_nodes

Role: TypeAlias = Literal["wall", "farfield", "inflow", "outflow", "symmetry", "other"]

_CUT, _UNNAMED = -2, -1
_SIGNS: tuple[tuple[Role, tuple[str, ...]], ...] = (
    ("farfield", ("far", "freestream")),
    ("inflow", ("inlet", "inflow")),
    ("outflow", ("outlet", "outflow")),
    ("symmetry", ("symm",)),
    ("wall", ("wall", "airfoil", "body", "surface", "blade")),
)


def cut(grid: Grid) -> tuple[Patch, Patch] | None:
    """Return the two stretches that lie on each other inside the domain, or None.

    Those of an O grid, west and east, run alike; those of a C grid's wake run against each other.
    """
    if grid.topology == "o":
        return Patch("cut", "west", 0, grid.nj - 1), Patch("cut", "east", 0, grid.nj - 1)
    wake = wake_nodes(grid.nodes[:, 0]) if grid.topology == "c" else 0
    if wake < 2:
        return None
    return Patch("cut", "south", 0, wake - 1), Patch("cut", "south", grid.ni - wake, grid.ni - 1)


def patches(grid: Grid) -> list[Patch]:
    """Return the outer boundary without the cut, each edge in one stretch.

    Where parts overlap the later one counts; what nobody named is called by its side.
    """
    found = []
    seam = cut(grid) or ()
    for side in SIDES:
        count = (grid.ni if side in ("south", "north") else grid.nj) - 1
        owner = np.full(count, _UNNAMED)
        for k, part in enumerate(grid.patches):
            if part.side == side:
                owner[part.start : part.stop] = k
        for part in seam:
            if part.side == side:
                owner[part.start : part.stop] = _CUT
        ends = np.flatnonzero(np.diff(owner)) + 1
        for start, stop in zip([0, *ends.tolist()], [*ends.tolist(), count], strict=True):
            k = int(owner[start])
            if k != _CUT:
                found.append(Patch(side if k == _UNNAMED else grid.patches[k].name, side, start, stop))
    return found


def roles(grid: Grid, stretches: Iterable[Patch]) -> dict[str, Role]:
    """Return what each name of `stretches` stands for, told by the name, and for a body by its side."""
    found: dict[str, Role] = {}
    for part in stretches:
        body = grid.topology != "quad" and part.side == "south"
        told = next((role for role, signs in _SIGNS if any(s in part.name.lower() for s in signs)), None)
        found.setdefault(part.name, told or ("wall" if body else "other"))
    return found
