"""The cells at a wall: first-cell heights, and the angles at which grid lines leave the wall."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from meshonet.geometry.arrays import Floats, cross2, norms, percentiles_of
from meshonet.geometry.blocks.across import rows_at
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.elementary import arctan2
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.measure import per_cell_of_blocks

DEPTH = 33  # number of nodes along a line that are examined for equal cells
NO_GROWTH: Mapping[str, Extreme] = MappingProxyType({})
SAME = 0.01  # relative difference up to which two heights count as equal


@dataclass(frozen=True)
class Spread:
    """Minimum, mean and maximum of a quantity; in multi-block grids also the 95th percentile."""

    min: float
    mean: float
    max: float
    p95: float | None = None  # 95th percentile; None in a grid of one block


@dataclass(frozen=True)
class WallRow:
    """Figures of the first cells at a wall; in a multi-block grid, at all walls with the same name."""

    name: str
    side: str | None  # the side of the block; None if the name is on several sides
    height: Spread  # distance from each wall node to the next node of its line, in the grid's unit
    off_square: Spread  # deviation from 90 degrees of angles at the wall, in volumes from its normal
    equal_cells: int  # fewest cells in a row from the wall, at most 32, with heights within 1 % of the first
    growth: Extreme | None = None  # with blocks: growth along the lines from the wall, through all blocks


def wall_rows(
    grid: Grid, walls: Sequence[Patch], growth: Mapping[str, Extreme] = NO_GROWTH
) -> tuple[WallRow, ...]:
    """Return the figures of the first cells at each wall; walls of a multi-block grid are joined by name.

    `growth` is the growth along the grid lines from each wall, by the name of the wall.
    """
    if grid.topology != "blocks":
        return tuple(_row(wall.name, wall.side, [_wall_part(grid, wall)]) for wall in walls)
    names = dict.fromkeys(wall.name for wall in walls)
    rows = []
    for name in names:
        parts = [wall for wall in walls if wall.name == name]
        sides = {wall.side for wall in parts}
        side = sides.pop() if len(sides) == 1 else None
        row = _row(name, side, [_wall_part(grid, wall) for wall in parts], percentile=True)
        rows.append(replace(row, growth=growth.get(name)))
    return tuple(rows)


@dataclass(frozen=True)
class _WallPart:
    """Heights and angles at one stretch of wall, and the least number of equal cells on a line."""

    heights: Floats
    off: Floats
    equal: int


def _wall_part(grid: Grid, patch: Patch) -> _WallPart:
    layers = rows_at(grid, patch, DEPTH)
    steps = np.diff(layers, axis=0)
    heights = norms(steps)
    equal = np.abs(heights - heights[0]) <= SAME * heights[0]
    alike = np.where(equal.all(axis=0), len(equal), np.argmin(equal, axis=0))
    if grid.form == "volume":
        off = _off_normal(layers[0], steps[0])
    else:
        along = np.diff(layers[0], axis=0)
        off = [_off_square(along, steps[0, :-1]), _off_square(along, steps[0, 1:])]
    return _WallPart(heights[0].ravel(), np.stack(off), int(alike.min()))


def _off_normal(wall: Floats, away: Floats) -> list[Floats]:
    """Return the angles between edges (n, m, 3) off a wall and normals at its corners."""
    along, across = np.diff(wall, axis=0), np.diff(wall, axis=1)
    off = []
    for a in (0, 1):
        for b in (0, 1):
            u, v = (along[:, 1:], along[:, :-1])[1 - b], (across[1:], across[:-1])[1 - a]
            w = away[a : len(across) - 1 + a, b : along.shape[1] - 1 + b]
            normal = np.cross(u, v)
            off.append(np.degrees(arctan2(norms(np.cross(normal, w)), np.abs((normal * w).sum(axis=-1)))))
    return off


def _row(name: str, side: str | None, parts: Sequence[_WallPart], *, percentile: bool = False) -> WallRow:
    heights = _spread([part.heights for part in parts], percentile=percentile)
    off = _spread([part.off for part in parts], percentile=percentile)
    return WallRow(name, side, heights, off, min(part.equal for part in parts))


def _off_square(along: Floats, away: Floats) -> Floats:
    """Return the deviations from 90 degrees of the angles between two families of vectors (n, d)."""
    sine = norms(np.cross(along, away)) if along.shape[1] == 3 else np.abs(cross2(along, away))
    return np.degrees(arctan2(np.abs((along * away).sum(axis=1)), sine))


def _spread(parts: Sequence[Floats], *, percentile: bool) -> Spread:
    values = parts[0] if len(parts) == 1 else np.concatenate([part.ravel() for part in parts])
    p95 = percentiles_of(values, (95,))[0] if percentile else None
    return Spread(float(values.min()), float(values.mean()), float(values.max()), p95)


def skewness_at(grid: Grid, walls: Sequence[Patch]) -> dict[str, Extreme]:
    """Return the skewness of the cells at each of the `walls` of a volume, by the name of the wall."""
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
