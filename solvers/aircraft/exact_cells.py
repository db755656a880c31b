"""First cells of a given height in space, of lines whose nodes are places in the map around a body."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.solvers.aircraft.body_map import BodyMap

_ROUNDS = 6
"""Times a place is scaled along its line; the map is nearly linear over a first cell."""


def at_height(space: BodyMap, wall: Floats, beside: Floats, first: float, rounds: int = _ROUNDS) -> Floats:
    """Return the places (..., 3) on the lines from `wall` to `beside` (..., 3) at the distance `first`."""
    away, foot = beside - wall, space.points(wall)
    for _ in range(rounds):
        away = away * (first / norms(space.points(wall + away) - foot))[..., None]
    return wall + away


def between_walls(walls: tuple[Floats, Floats], beside: Floats, first: float) -> Floats:
    """Return the points (n, 3) nearest to `beside` (n, 3) at the distance `first` from two points (n, 3).

    These are at most twice as far apart.
    """
    middle, half = 0.5 * (walls[0] + walls[1]), 0.5 * (walls[1] - walls[0])
    away, square = beside - middle, (half * half).sum(axis=-1)
    away -= ((away * half).sum(axis=-1) / square)[..., None] * half
    return middle + away * (np.sqrt(np.maximum(first * first - square, 0.0)) / norms(away))[..., None]
