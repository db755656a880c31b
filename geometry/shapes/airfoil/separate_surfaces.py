"""Surfaces that touch or cross by rounding of their coordinates, moved apart.

Where a section is thinner than the digits of its file resolve, as at a cusped trailing edge, the two surfaces
coincide or cross. Points there are moved across the chord, by half the missing thickness each and at most
`MOST` chords.
"""

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across

MOST = 4.5e-5
"""Chords by which a point may move."""
_WEDGE = 0.02  # near an edge the least thickness grows from nothing by this much of the distance


def moved_apart(ring: Floats, nose: int) -> Floats:
    """Return a ring (n, 2) with its surfaces moved apart, by `MOST` chords each at the most.

    They are then twice `MOST` chords apart, or as far as this allows.

    It runs clockwise from the trailing edge, which stays, as does the leading edge, the point `nose`.
    """
    edge = ring[0]
    axis = ring[nose] - edge
    chord = float(np.hypot(*axis))
    axis = axis / chord
    across = np.array([axis[1], -axis[0]])  # to the upper side
    along, below = along_and_across(ring - edge, axis)
    height = -below
    lower = np.arange(nose + 1)
    upper = np.append(np.arange(nose, len(ring)), 0)
    places = np.sort(along)
    sides = [np.interp(places, *_single_valued(along[side], height[side])) for side in (lower, upper)]
    least = np.minimum(2 * MOST * chord, _WEDGE * np.minimum(places, chord - places))
    need = np.clip(0.5 * (least - (sides[1] - sides[0])), 0.0, MOST * chord)
    shift = np.interp(along, places, need)
    shift[[0, nose]] = 0.0
    sign = np.where(np.arange(len(ring)) < nose, -1.0, 1.0)
    return np.asarray(ring + (sign * shift)[:, None] * across)


def _single_valued(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    order = np.argsort(x, kind="stable")
    return x[order], y[order]
