"""The cells at a wall: how high the first ones are, and at what angle the grid lines leave it."""

from __future__ import annotations

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


@dataclass(frozen=True)
class WallRow:
    """The row of cells at one named stretch of wall."""

    name: str
    side: str
    height: Spread
    """Distance from each wall node to the next node of the line that leaves it, in the grid's unit."""
    off_square: Spread
    """Deviation from 90 degrees of the two angles of every cell at the wall."""
    equal_cells: int
    """Cells from the wall on as high as the first, within 1 %, where they are fewest; 32 at the most."""


def wall_row(grid: Grid, patch: Patch) -> WallRow:
    """Return the figures of the cells at `patch` of the boundary of `grid`."""
    lines = leaving(grid, patch)
    steps = np.diff(lines, axis=1)
    heights = np.hypot(steps[..., 0], steps[..., 1])
    equal = np.abs(heights - heights[:, :1]) <= SAME * heights[:, :1]
    alike = np.where(equal.all(axis=1), equal.shape[1], np.argmin(equal, axis=1))
    along = np.diff(lines[:, 0], axis=0)
    off = [_off_square(along, steps[:-1, 0]), _off_square(along, steps[1:, 0])]
    return WallRow(patch.name, patch.side, _spread(heights[:, 0]), _spread(np.stack(off)), int(alike.min()))


def leaving(grid: Grid, patch: Patch) -> Floats:
    """Return the lines (n, depth, 2) that leave the nodes of `patch`, the wall first."""
    nodes = grid.nodes if patch.side in ("south", "north") else grid.nodes.swapaxes(0, 1)
    nodes = nodes[patch.start : patch.stop + 1]
    return (nodes if patch.side in ("south", "west") else nodes[:, ::-1])[:, :DEPTH]


def _off_square(along: Floats, away: Floats) -> Floats:
    """Return how far the angles between two families of vectors (n, 2) are from 90 degrees."""
    sine = np.abs(along[:, 0] * away[:, 1] - along[:, 1] * away[:, 0])
    return np.degrees(np.arctan2(np.abs((along * away).sum(axis=1)), sine))


def _spread(values: Floats) -> Spread:
    return Spread(float(values.min()), float(values.mean()), float(values.max()))
