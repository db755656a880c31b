"""First cells of a given height in space, of lines whose nodes are places in the map around a body."""

from __future__ import annotations

from meshonet.geometry.arrays import Floats, norms
from meshonet.solvers.aircraft.body_map import BodyMap

_ROUNDS = 6
"""Times a place is scaled along its line; the map is nearly linear over a first cell."""
_CORNER_ROUNDS = 200
"""Times a place beside two walls is scaled from each of them, in turn."""


def at_height(space: BodyMap, wall: Floats, beside: Floats, first: float, rounds: int = _ROUNDS) -> Floats:
    """Return the places (..., 3) on the lines from `wall` to `beside` (..., 3) at the distance `first`."""
    away, foot = beside - wall, space.points(wall)
    for _ in range(rounds):
        away = away * (first / norms(space.points(wall + away) - foot))[..., None]
    return wall + away


def at_heights(space: BodyMap, walls: tuple[Floats, Floats], beside: Floats, first: float) -> Floats:
    """Return places (n, 3) near `beside` (n, 3) at the distance `first` from two places (n, 3) on walls."""
    for _ in range(_CORNER_ROUNDS):
        for wall in walls:
            beside = at_height(space, wall, beside, first, 1)
    return beside
