"""What flow solvers call the boundary's patches."""

from __future__ import annotations

from collections.abc import Iterable

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind, Patch


def kinds(grid: Grid, patches: Iterable[Patch]) -> dict[str, Kind]:
    """Return the kind of boundary of each name of `patches`; an unnamed one of a body is a wall."""
    found: dict[str, Kind] = {}
    for patch in patches:
        body = grid.around_body and patch.side == "south"
        found.setdefault(patch.name, "wall" if body and patch.kind in ("other", "interface") else patch.kind)
    return found
