"""First cells of given height in space, for lines in the map around a body."""

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import exp, log
from meshonet.solvers.aircraft.body_map import BodyMap

_ROUNDS = 6  # number of trial values of t
_STILL = 1e-12  # smallest relative change of a distance from which the exponent is estimated
_INVERSES = 0.2, 5.0  # range of the reciprocal of the exponent


def at_height(space: BodyMap, wall: Floats, beside: Floats, first: float) -> Floats:
    """Return the places (..., 3) at the distance `first` from `wall` on lines towards `beside` (..., 3).

    All places are s, theta, zeta of `BodyMap`; the distance is physical. The positions on the lines are found
    by iteration, even where the distance is not linear in the position, as at a pointed nose.
    """
    away, foot = beside - wall, space.points(wall)
    scale = inverse = np.ones(away.shape[:-1])
    step = before = np.zeros_like(scale)
    for number in range(_ROUNDS):
        short = log(first / norms(space.points(wall + scale[..., None] * away) - foot))
        if number:
            change = before - short
            known = np.abs(change) > _STILL
            inverse = np.where(known, step / np.where(known, change, 1.0), inverse)
        step, before = np.clip(inverse, *_INVERSES) * short, short
        scale = scale * exp(step)
    return wall + scale[..., None] * away


def between_walls(walls: tuple[Floats, Floats], beside: Floats, first: float) -> Floats:
    """Return n points (n, 3) between two walls, at the distance `first` from a point of each wall.

    `walls` has one array (n, 3) of points per wall. The two points for one result must be at most twice
    `first` apart. Of all points at these distances, those nearest to `beside` (n, 3) are returned.
    """
    middle, half = 0.5 * (walls[0] + walls[1]), 0.5 * (walls[1] - walls[0])
    away, square = beside - middle, (half * half).sum(axis=-1)
    away -= ((away * half).sum(axis=-1) / square)[..., None] * half
    return middle + away * (np.sqrt(np.maximum(first * first - square, 0.0)) / norms(away))[..., None]
