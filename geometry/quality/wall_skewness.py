"""Skewness of the cells at the walls of a volume, which is greatest at edges of bodies."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, percentiles_of
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.measure import per_cell_of_blocks


def skewness_at(grid: Grid, walls: Sequence[Patch]) -> dict[str, Extreme]:
    """Return, by name of the wall, the skewness of the cells at each of the `walls` of a volume."""
    cells = per_cell_of_blocks(grid, "skewness")
    stretches: dict[str, list[tuple[Floats, Patch]]] = {}
    for wall in walls:
        axis, end = PLACES[wall.side]
        face = np.moveaxis(cells[wall.block], axis, 0)[end]
        (a, b), (c, d) = wall.range(tuple(n + 1 for n in face.shape))
        stretches.setdefault(wall.name, []).append((face[a:b, c:d], wall))
    return {name: _extreme(grid, parts) for name, parts in stretches.items()}


def _extreme(grid: Grid, parts: Sequence[tuple[Floats, Patch]]) -> Extreme:
    """Return the extreme of values (n, m) of the cells at stretches of a wall."""
    values, wall = max(parts, key=lambda part: float(part[0].max()))
    axis, end = PLACES[wall.side]
    last = grid.blocks[wall.block].counts[axis] - 2
    place = [int(index) for index in np.unravel_index(int(values.argmax()), values.shape)]
    starts = [first for first, _ in wall.range(tuple(n + 1 for n in values.shape))]
    at = [index + start for index, start in zip(place, starts, strict=True)]
    at.insert(axis, last if end else 0)
    every = np.concatenate([part.ravel() for part, _ in parts])
    return Extreme(
        float(values.max()), float(every.mean()), (wall.block, *at), percentiles_of(every, (99,))[0]
    )
