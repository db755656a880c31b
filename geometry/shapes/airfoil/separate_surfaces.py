"""Moves apart surfaces that touch or cross because of rounded coordinates.

Where a section is thinner than the digits of its file resolve, as at a cusped trailing edge, its surfaces
coincide or cross. Points there are moved normal to the chord, each by half the missing thickness and at most
`MOST` chords.
"""

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across

MOST = 4.5e-5
"""Largest displacement of a point, in chords."""
_WEDGE = 0.02  # near an edge the least thickness is this fraction of the distance from it


def moved_apart(ring: Floats, nose: int) -> Floats:
    """Return a closed polygon (n, 2) with its surfaces moved apart, each by at most `MOST` chords.

    The surfaces are then 2 `MOST` chords apart, or less where points would have to move farther than `MOST`.
    The polygon runs clockwise from the trailing edge. The trailing edge and the leading edge (the point with
    index `nose`) do not move.
    """
    chord = float(np.hypot(*(ring[nose] - ring[0])))

    def least(places: Floats, _: Floats) -> Floats:
        return np.minimum(2 * MOST * chord, _WEDGE * np.minimum(places, chord - places))

    return _thickened(ring, nose, least, MOST * chord)


def wedged_apart(ring: Floats, nose: int, thin: float) -> Floats:
    """Return a closed polygon (n, 2), thickened near its trailing edge to at least a wedge.

    The wedge begins at the trailing edge, as thick as the base if there is one, and ends where its thickness
    is `thin`.
    """

    def least(places: Floats, thickness: Floats) -> Floats:
        end = min(int(np.argmax(np.append(thickness, thin) >= thin)), len(places) - 1)
        base = max(thickness[0], 0.0)
        wedge = base + (thickness[end] - base) * places / max(places[end], np.finfo(float).tiny)
        return np.where(np.arange(len(places)) < end, wedge, thickness)

    return _thickened(ring, nose, least, thin)


def _thickened(ring: Floats, nose: int, least: Callable[[Floats, Floats], Floats], most: float) -> Floats:
    """Return a closed polygon with each surface moved by half the missing thickness, at most by `most`.

    `least` returns the least thickness (n,) at ascending distances (n,) from the edge along the chord,
    where the section has thickness (n,).
    """
    edge = ring[0]
    axis = ring[nose] - edge
    axis = axis / np.hypot(*axis)
    across = np.array([axis[1], -axis[0]])  # towards the upper side
    along, below = along_and_across(ring - edge, axis)
    height = -below
    lower = np.arange(nose + 1)
    upper = np.append(np.arange(nose, len(ring)), 0)
    places = np.sort(along)
    sides = [np.interp(places, *_single_valued(along[side], height[side])) for side in (lower, upper)]
    thickness = sides[1] - sides[0]
    need = np.clip(0.5 * (least(places, thickness) - thickness), 0.0, most)
    shift = np.interp(along, places, need)
    shift[[0, nose]] = 0.0
    sign = np.where(np.arange(len(ring)) < nose, -1.0, 1.0)
    return np.asarray(ring + (sign * shift)[:, None] * across)


def _single_valued(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    order = np.argsort(x, kind="stable")
    return x[order], y[order]
