"""Moves apart surfaces that touch or cross because of rounded coordinates.

Where a section is thinner than the digits of its file resolve, as at a cusped trailing edge, its surfaces
coincide or cross. Points there are moved normal to the chord, each by half the missing thickness and at most
`MOST` chords.
"""

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across

MOST = 4.5e-5
"""Largest displacement of a point, in chords."""
_WEDGE = 0.02  # near an edge the least thickness is this fraction of the distance from it


def moved_apart(ring: Floats, nose: int) -> Floats:
    """Return a closed polygon (n, 2) with its surfaces moved apart, each by at most `MOST` chords.

    They are then 2 `MOST` chords apart, or less if this limit does not allow that. The polygon runs clockwise
    from the trailing edge; that point and the leading edge, `nose`, are not moved.
    """
    edge = ring[0]
    axis = ring[nose] - edge
    chord = float(np.hypot(*axis))
    axis = axis / chord
    across = np.array([axis[1], -axis[0]])  # towards the upper side
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
