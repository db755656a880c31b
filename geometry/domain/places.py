"""Places on a loop by its corners, so that they mean the same on another loop with as many.

A place is the number of a corner and, behind the point, the part of the arc length to the next one; on a loop
without corners it is the part of its length from the first point.
"""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.polygon.corners import Indices


def place_at(loop: Loop, arc: Floats) -> Floats:
    """Return the places (n,) of arc lengths (n,); a corner's is a whole number, exactly."""
    arc = np.mod(arc, loop.length)
    if not loop.corners:
        return np.asarray(arc / loop.length)
    begins, lengths = _stretches(loop)
    number = (np.searchsorted(begins, arc, side="right") - 1) % len(begins)
    part = np.mod(arc - begins[number], loop.length) / lengths[number]
    return np.asarray(number + np.minimum(part, np.nextafter(1.0, 0.0)))


def arc_at(loop: Loop, place: Floats) -> Floats:
    """Return the arc lengths (n,), from 0 to below the length, of places (n,)."""
    if not loop.corners:
        return np.asarray(np.mod(place, 1.0) * loop.length)
    begins, lengths = _stretches(loop)
    number = np.floor(place).astype(np.intp)
    arc = begins[number % len(begins)] + (place - number) * lengths[number % len(begins)]
    return np.asarray(np.where(arc >= loop.length, arc - loop.length, arc))


def cells_at(loop: Loop, place: Floats) -> Indices:
    """Return how many cells should meet at places (n,) that are corners, 0 at others."""
    number = np.floor(place).astype(np.intp)
    if not loop.corners:
        return np.zeros(len(place), dtype=np.intp)
    return np.where(place == number, loop.corner_cells[number % len(loop.corners)], 0)


def _stretches(loop: Loop) -> tuple[Floats, Floats]:
    """Return where the stretches between corners begin, and how long they are."""
    begins = loop.corner_arcs
    return begins, np.diff(begins, append=begins[0] + loop.length)
