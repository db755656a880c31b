"""First cells of a given height in space, of lines whose nodes are places in the map around a body."""

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.elementary import exp, log
from meshonet.solvers.aircraft.body_map import BodyMap

_ROUNDS = 6  # number of trial values of t
_STILL = 1e-12  # smallest relative change of a distance from which the exponent is estimated
_INVERSES = 0.2, 5.0  # range of the reciprocal of the exponent


def at_height(space: BodyMap, wall: Floats, beside: Floats, first: float) -> Floats:
    """Return s, theta, zeta (..., 3) of the points on lines at the distance `first` in space from the wall.

    Each line leads from `wall` to `beside` (..., 3), both s, theta, zeta. Near the wall, the distance is
    proportional to a power of the fraction t of the line. The exponent (1 except at a pointed nose or tail)
    is estimated from the last two trial values of t.
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
    """Return points (n, 3) at the distance `first` from the corresponding points (n, 3) of two `walls`.

    Of all such points, those nearest to `beside` (n, 3) are returned. The two points on the walls must be at
    most twice `first` apart.
    """
    middle, half = 0.5 * (walls[0] + walls[1]), 0.5 * (walls[1] - walls[0])
    away, square = beside - middle, (half * half).sum(axis=-1)
    away -= ((away * half).sum(axis=-1) / square)[..., None] * half
    return middle + away * (np.sqrt(np.maximum(first * first - square, 0.0)) / norms(away))[..., None]
