"""Places on a loop relative to its corners, which carry over to other loops with as many corners."""

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.domain.loop import Loop


def place_at(loop: Loop, arc: Floats) -> Floats:
    """Return the place, a number (n,), of each point of a `loop`; `arc` (n,) are the points' arc lengths.

    Its integer part is the index of the last corner before the point. Its fractional part is the fraction of
    the arc length from this corner to the next. Without corners, it is the fraction of the whole length.
    """
    arc = np.mod(arc, loop.length)
    if not loop.corners:
        return np.asarray(arc / loop.length)
    begins, lengths = loop.pieces
    number = (np.searchsorted(begins, arc, side="right") - 1) % len(begins)
    part = np.mod(arc - begins[number], loop.length) / lengths[number]
    return np.asarray(number + np.minimum(part, np.nextafter(1.0, 0.0)))


def arc_at(loop: Loop, place: Floats) -> Floats:
    """Return arc lengths (n,) on a loop at `place` (n,); 2.25 is a quarter of the way from corner 2 to 3."""
    if not loop.corners:
        return np.asarray(np.mod(place, 1.0) * loop.length)
    begins, lengths = loop.pieces
    number = np.floor(place).astype(np.intp)
    arc = begins[number % len(begins)] + (place - number) * lengths[number % len(begins)]
    return np.asarray(np.where(arc >= loop.length, arc - loop.length, arc))


def cells_at(loop: Loop, place: Floats) -> Indices:
    """Return how many cells should meet at each `place` (n,) of a loop (see `place_at`); 0 if no corner."""
    number = np.floor(place).astype(np.intp)
    if not loop.corners:
        return np.zeros(len(place), dtype=np.intp)
    return np.where(place == number, loop.corner_cells[number % len(loop.corners)], 0)
