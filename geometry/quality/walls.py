"""The cells at a wall: how high the first ones are, and at what angle the grid lines leave it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch

DEPTH = 33
"""Nodes along a line that are looked at."""

SAME = 0.01
"""Relative difference up to which two heights count as equal."""


@dataclass(frozen=True)
class Spread:
    """Least, mean and greatest of something."""

    min: float
    mean: float
    max: float
    p95: float | None = None
    """95th percentile, in a grid of many blocks."""


@dataclass(frozen=True)
class WallRow:
    """The row of cells at one named stretch of wall; of many blocks, at all stretches of that name."""

    name: str
    side: str | None
    """None where a name is on several sides."""
    height: Spread
    """Distance from each wall node to the next node of the line that leaves it, in the grid's unit."""
    off_square: Spread
    """Deviation from 90 degrees of the two angles of every cell at the wall."""
    equal_cells: int
    """Cells from the wall on as high as the first, within 1 %, where they are fewest; 32 at the most."""


def wall_row(grid: Grid, patch: Patch) -> WallRow:
    """Return the figures of the cells at `patch` of the boundary of `grid`."""
    return _row(patch.name, patch.side, [_at(grid, patch)])


def wall_rows(grid: Grid, walls: Sequence[Patch]) -> tuple[WallRow, ...]:
    """Return the figures of the cells at `walls` of the boundary of `grid`, in many blocks by name."""
    if grid.topology != "blocks":
        return tuple(wall_row(grid, wall) for wall in walls)
    names = dict.fromkeys(wall.name for wall in walls)
    rows = []
    for name in names:
        parts = [wall for wall in walls if wall.name == name]
        sides = {wall.side for wall in parts}
        side = sides.pop() if len(sides) == 1 else None
        rows.append(_row(name, side, [_at(grid, wall) for wall in parts], percentile=True))
    return tuple(rows)


@dataclass(frozen=True)
class _At:
    """Heights and angles at one stretch of wall, and the fewest equal cells on a line."""

    heights: Floats
    off: Floats
    equal: int


def _at(grid: Grid, patch: Patch) -> _At:
    lines = leaving(grid, patch)
    steps = np.diff(lines, axis=1)
    heights = np.hypot(steps[..., 0], steps[..., 1])
    equal = np.abs(heights - heights[:, :1]) <= SAME * heights[:, :1]
    alike = np.where(equal.all(axis=1), equal.shape[1], np.argmin(equal, axis=1))
    along = np.diff(lines[:, 0], axis=0)
    off = [_off_square(along, steps[:-1, 0]), _off_square(along, steps[1:, 0])]
    return _At(heights[:, 0], np.stack(off), int(alike.min()))


def _row(name: str, side: str | None, parts: Sequence[_At], *, percentile: bool = False) -> WallRow:
    heights = _spread([part.heights for part in parts], percentile=percentile)
    off = _spread([part.off for part in parts], percentile=percentile)
    return WallRow(name, side, heights, off, min(part.equal for part in parts))


def leaving(grid: Grid, patch: Patch) -> Floats:
    """Return the lines (n, depth, 2) that leave the nodes of `patch`, the wall first."""
    nodes = grid.blocks[patch.block].nodes
    nodes = nodes if patch.side in ("south", "north") else nodes.swapaxes(0, 1)
    nodes = nodes[patch.start : patch.stop + 1]
    return (nodes if patch.side in ("south", "west") else nodes[:, ::-1])[:, :DEPTH]


def _off_square(along: Floats, away: Floats) -> Floats:
    """Return how far the angles between two families of vectors (n, 2) are from 90 degrees."""
    sine = np.abs(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0])
    return np.degrees(np.arctan2(np.abs((along * away).sum(axis=1)), sine))


def _spread(parts: Sequence[Floats], *, percentile: bool) -> Spread:
    values = parts[0] if len(parts) == 1 else np.concatenate([part.ravel() for part in parts])
    p95 = float(np.percentile(values, 95.0)) if percentile else None
    return Spread(float(values.min()), float(values.mean()), float(values.max()), p95)
