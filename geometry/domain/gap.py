"""The free distance in front of the walls of a domain."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of, norms, shortest_ways
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.kernels._native import nearest_ahead

IN_FRONT = 0.6
"""Cosine of the largest angle, 53 degrees, between the normal and the direction of a wall point in front."""
_BEYOND = 1.0 + 1e-9
"""Factor on a limit, so that a value that equals the limit except for rounding does not exceed it."""
_SAME = 1e-9  # wall points nearer than this fraction of the extent of the walls are the point itself
_AROUND_CORNER = 1.1
"""Ratio of arc length to distance up to which a point is around a corner; at 135 degrees it is 1.08."""
_SAMPLES = 2000  # points on all walls together


def wall_gaps(domain: Domain, loop: Loop, arcs: Floats) -> Floats:
    """Return distances (n,) from points of a loop, at arc lengths `arcs` (n,), to the nearest wall in front.

    A wall of any loop is in front if the direction from the point to it deviates from the inward normal by at
    most 53 degrees. Without a wall in front, the distance is infinite. There is one exception: two walls that
    form an obtuse corner, where two cells of the grid are to meet, are never in front of each other.
    """
    walls, points, along = wall_points(domain.loops), loop.at(arcs), loop.tangent(arcs)
    gaps = gaps_in_front(walls, points, along)
    if not ((loop.corner_cells == 2) & (loop.corner_angles < 180.0)).any():
        return gaps
    counts, number = _sample_counts(domain.loops), domain.loops.index(loop)
    first, last = sum(counts[:number]), sum(counts[: number + 1])
    along_wall = loop.length * np.linspace(0.0, 1.0, counts[number], endpoint=False)
    for k, arc in enumerate(arcs.tolist()):
        away = np.abs(shortest_ways(along_wall - arc, loop.length))
        counted = np.ones(len(walls), dtype=bool)
        counted[first:last] = away > _AROUND_CORNER * norms(walls[first:last] - points[k])
        gaps[k : k + 1] = gaps_in_front(walls[counted], points[k : k + 1], along[k : k + 1])
    return gaps


def wall_points(loops: Sequence[Loop]) -> Floats:
    """Return points (m, 2) at nearly equal distances on all loops, at least 32 on each."""
    counts = _sample_counts(loops)
    return np.concatenate([each.sample(count) for each, count in zip(loops, counts, strict=True)])


def _sample_counts(loops: Sequence[Loop]) -> list[int]:
    total = sum(each.length for each in loops)
    return [max(32, round(_SAMPLES * each.length / total)) for each in loops]


def gaps_in_front(walls: Floats, points: Floats, along: Floats) -> Floats:
    """Return distances (n,) from `points` (n, 2) on a wall to the nearest point of `walls` (m, 2) in front.

    `along` (n, 2) are unit tangents of the wall at `points`; the normal points to their left. A wall point is
    in front if its direction deviates from the normal by at most 53 degrees. If there is none: infinity.
    """
    gaps, same = np.empty(len(points)), _SAME * extent_of(walls)
    walls, points, along = (np.ascontiguousarray(each) for each in (walls, points, along))
    nearest_ahead(walls, points, along, _BEYOND * IN_FRONT, same, gaps)
    return gaps
