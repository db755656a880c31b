"""Moves apart surfaces that touch or cross because of rounded coordinates, normal to the chord."""

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats, along_and_across

MOST = 4.5e-5  # largest displacement of a point, in chords
_WEDGE = 0.02  # near an edge the least thickness is this fraction of the distance from it


def moved_apart(ring: Floats, nose: int) -> Floats:
    """Return a closed polygon (n, 2) whose two surfaces are moved apart, by up to `MOST` chords each.

    The polygon `ring` runs clockwise from the trailing edge. The trailing edge and the leading edge, which
    has the index `nose`, do not move.
    """
    chord = float(np.hypot(*(ring[nose] - ring[0])))

    def least(places: Floats, _: Floats) -> Floats:
        return np.minimum(2 * MOST * chord, _WEDGE * np.minimum(places, chord - places))

    return _thickened(ring, nose, least, MOST * chord)


def wedged_apart(ring: Floats, nose: int, thin: float) -> Floats:
    """Return a closed polygon (n, 2) that is at least as thick as a wedge near its trailing edge.

    The wedge begins at the trailing edge, with the edge's thickness, and ends where the polygon `ring` has
    the thickness `thin`.
    """

    def least(places: Floats, thickness: Floats) -> Floats:
        end = min(int(np.argmax(np.append(thickness, thin) >= thin)), len(places) - 1)
        base = max(thickness[0], 0.0)
        wedge = base + (thickness[end] - base) * places / max(places[end], np.finfo(float).tiny)
        return np.where(np.arange(len(places)) < end, wedge, thickness)

    return _thickened(ring, nose, least, thin)


def _thickened(ring: Floats, nose: int, least: Callable[[Floats, Floats], Floats], most: float) -> Floats:
    """Return a closed polygon with both surfaces moved by half the missing thickness, at most by `most`.

    `least` has distances from the edge (n,) and thickness (n,) there, and returns the least thickness (n,).
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
    rising = [side[np.argsort(along[side], kind="stable")] for side in (lower, upper)]
    sides = [np.interp(places, along[side], height[side]) for side in rising]
    thickness = sides[1] - sides[0]
    need = np.clip(0.5 * (least(places, thickness) - thickness), 0.0, most)
    shift = np.interp(along, places, need)
    shift[[0, nose]] = 0.0
    sign = np.where(np.arange(len(ring)) < nose, -1.0, 1.0)
    return np.asarray(ring + (sign * shift)[:, None] * across)
