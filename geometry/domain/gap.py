"""The free distance in front of the walls of a domain."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.kernels._native import nearest_ahead

IN_FRONT = 0.6
"""Cosine of the angle to the normal up to which a wall counts as being in front: 53 degrees."""
_BEYOND = 1.0 + 1e-9
"""Factor on a limit, so that a value equal to it except for rounding does not exceed it."""
_SAME = 1e-9
"""Distance over the extent of the walls up to which a wall point is the point itself, and no gap."""
_SAMPLES = 2000  # points on all walls together


def wall_gaps(domain: Domain, loop: Loop, arcs: Floats) -> Floats:
    """Return the distance (n,) from points of a loop to the nearest wall in front, infinite without one.

    The points are at arc lengths `arcs` (n,). A wall, which may be part of the same loop, is in front if the
    cosine of its direction to the inward normal exceeds `IN_FRONT`.
    """
    return gaps_in_front(wall_points(domain.loops), loop.at(arcs), loop.tangent(arcs))


def wall_points(loops: Sequence[Loop]) -> Floats:
    """Return points (m, 2) on all loops, about `_SAMPLES` in total and at least 32 on each."""
    total = sum(each.length for each in loops)
    return np.concatenate([each.sample(max(32, round(_SAMPLES * each.length / total))) for each in loops])


def gaps_in_front(walls: Floats, points: Floats, along: Floats) -> Floats:
    """Return the distance (n,) from `points` (n, 2) to the nearest of the wall points (m, 2) in front.

    `along` (n, 2) are unit directions, whose normals point to their left. A wall point is in front if the
    cosine of its direction to the normal exceeds `IN_FRONT`.
    """
    gaps, same = np.empty(len(points)), _SAME * extent_of(walls)
    walls, points, along = (np.ascontiguousarray(each) for each in (walls, points, along))
    nearest_ahead(walls, points, along, _BEYOND * IN_FRONT, same, gaps)
    return gaps
