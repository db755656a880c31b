"""Features of multi-block grids in a picture: block outlines, irregular vertices, continuous grid lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from meshonet.formats.figure.layers import INK, CellsInView, line_gaps, line_step
from meshonet.geometry.arrays import SIDES
from meshonet.geometry.blocks.families import families
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import irregular_points

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_FEW, _MANY = "#f2b705", "#e4572e"  # colours of vertices at which fewer or more than four cells meet
Lines = tuple[tuple[int, int], tuple[bool, bool]]
"""Steps between drawn lines i = const and j = const, and whether they are counted from the last line."""


def lines_of_blocks(
    grid: Grid, singles: Sequence[Grid], parts: Sequence[CellsInView | None], pixels: float, every: int | None
) -> list[Lines]:
    """Return which grid lines to draw in each block, so that drawn lines continue across block boundaries.

    `singles` has each block as a grid. `parts` has the visible cells of each block, None if it has none.
    """
    steps = [[every or 1, every or 1] for _ in singles]
    flips = [[False, False] for _ in singles]
    gaps = [line_gaps(single, part) if part else None for single, part in zip(singles, parts, strict=True)]
    for family in families(grid):
        # lines along eta are those of constant i
        seen = [pair[1 - member.axis] for member in family if (pair := gaps[member.block])]
        if seen and not every:
            length, area = (np.concatenate([gap[k] for gap in seen]) for k in (0, 1))
            step = line_step(length, area, pixels)
            for member in family:
                steps[member.block][1 - member.axis] = step
        for member in family:
            flips[member.block][1 - member.axis] = member.flipped
    return [((a, b), (c, d)) for (a, b), (c, d) in zip(steps, flips, strict=True)]


def outline_blocks(ax: Axes, grid: Grid) -> None:
    """Draw the sides of all blocks; sides on the outer boundary are thicker."""
    from matplotlib.collections import LineCollection

    sides = [block.face(side) for block in grid.blocks for side in SIDES]
    ax.add_collection(LineCollection(sides, colors=INK, linewidths=0.8, zorder=4))
    outer = list(map(grid.at, grid.outer_patches()))
    ax.add_collection(LineCollection(outer, colors=INK, linewidths=1.4, zorder=4))


def mark_vertices(ax: Axes, grid: Grid) -> None:
    """Draw a dot at each irregular interior vertex, and a legend of the colours."""
    points, cells = irregular_points(grid)
    kinds = (cells < 4, _FEW, "3 cells meet"), (cells > 4, _MANY, "5 or more cells meet")
    for among, colour, label in kinds:
        if among.any():
            x, y = points[among].T
            ax.scatter(x, y, s=26, c=colour, edgecolors=INK, linewidths=0.8, zorder=6, label=label)
    if len(points):
        ax.legend(loc="upper right", fontsize=7, framealpha=0.85, borderpad=0.4, handletextpad=0.2)


def shown_counts(grid: Grid) -> str:
    """Return the numbers of blocks and cells of a grid as text."""
    return f"{len(grid.blocks)} block{'s' * (len(grid.blocks) > 1)}, {grid.cells} cells"
