"""Note for the report about first cells and growth at walls with layers, measured on the grid."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import may_be_wall
from meshonet.geometry.blocks.vertices import vertices
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.quality.lines import lines
from meshonet.geometry.quality.walls import wall_rows
from meshonet.geometry.spacing.y_plus import first_cell_note


def wall_note(grid: Grid, domain: Domain, names: Collection[str], first: float) -> str:
    """Return a note on the heights of first cells and the growth of rows at the walls with layers.

    Parameters
    ----------
    grid : grid of blocks, or of one ring.
    domain : its domain.
    names : names of the walls with layers; empty for those of `Domain.layered_loops`.
    first : prescribed height in the domain's unit.
    """
    unnamed = (name for number in domain.layered_loops for name in domain.loops[number].names)
    layered = set(names) or set(filter(may_be_wall, unnamed))
    patches = tuple(replace(p, kind="wall") if p.name in layered else p for p in grid.patches)
    grid = replace(grid, patches=patches)
    walls = [patch for patch in grid.walls() if patch.name in layered]
    rows = wall_rows(grid, walls, lines(grid, vertices(grid)).by_wall)
    low, high = min(row.height.min for row in rows), max(row.height.max for row in rows)
    growth = max((row.growth.mean for row in rows if row.growth), default=None)
    where = f"node of {', '.join(names)}" if names else "wall node"
    return first_cell_note(low, high, first, growth, where)
