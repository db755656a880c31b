"""First cells at walls and growth ratios, measured on the grid for the report."""

from __future__ import annotations

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import vertices
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.lines import Lines, lines, solid_lines
from meshonet.geometry.quality.verdicts import named
from meshonet.geometry.quality.walls import wall_rows

_SAME = 1e-6
"""Relative tolerance for equal first cells, and for growth above its limit."""


def wall_facts(grid: Grid, growth: float | None) -> tuple[str, ...]:
    """Return notes on first cells and growth at each wall of a multi-block grid, planar or in space.

    If neighbouring cells differ by more than `growth`, a further note gives the place of the largest ratio,
    along a line that leaves a wall or across an interface.
    """
    run = solid_lines(grid, percentiles=False) if grid.form == "volume" else lines(grid, vertices(grid))
    notes = []
    for row in wall_rows(grid, grid.walls(), run.by_wall):
        low, high = row.height.min, row.height.max
        cells = f"{low:.6g}" if high - low <= _SAME * high else f"{low:.6g} to {high:.6g}"
        rows = f", growth up to {row.growth.max:.3f} along lines from it" if row.growth else ""
        notes.append(f"{row.name}: first cells {cells}{rows}")
    largest = largest_growth(run)
    if growth is not None and largest is not None and largest.max > growth * (1.0 + _SAME):
        where = f"neighbouring cells differ by up to {largest.max:.3f} at node {named(largest.at)}"
        notes.append(f"{where}, more than the growth of {growth:g}")
    return tuple(notes)


def largest_growth(run: Lines) -> Extreme | None:
    """Return the largest ratio of neighbouring cells along lines from walls and across interfaces."""
    found = [extreme for extreme in (run.leaving, run.growth_across) if extreme]
    return max(found, key=lambda extreme: extreme.max, default=None)
