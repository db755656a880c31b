"""The outer boundary as solvers want it: every edge in one named stretch or in the cut."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch

Role: TypeAlias = Literal["wall", "farfield", "inflow", "outflow", "symmetry", "other"]

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
    if len(grid.connections) != 1:
        return None
    first, second = grid.connections[0].stretches(0)
    return Patch("cut", *first), Patch("cut", *second)


def patches(grid: Grid) -> list[Patch]:
    """Return the outer boundary without the cut, each edge in one stretch."""
    return grid.outer_patches()


def roles(grid: Grid, stretches: Iterable[Patch]) -> dict[str, Role]:
    """Return what each name of `stretches` stands for, told by the name, and for a body by its side."""
    found: dict[str, Role] = {}
    for part in stretches:
        body = grid.around_body and part.side == "south"
        told = next((role for role, signs in _SIGNS if any(s in part.name.lower() for s in signs)), None)
        found.setdefault(part.name, told or ("wall" if body else "other"))
    return found
