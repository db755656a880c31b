"""Places of nodes around a blade that lie opposite each other on both sides."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.monotone import monotone_cubic


def opposite_places(places: Floats) -> Floats:
    """Return places u (k,) of nodes clockwise around a blade with both sides' opposite each other.

    As many nodes lie on each side, at equal parts of the sides' lengths: blocks inside the blade's outline,
    in a gap, are then not skew. k is even; nodes lie at both edges.
    """
    k = len(places)
    half, lead = k // 2, _leading_node(places)
    along = places[0] + np.concatenate([[0.0], np.cumsum(np.mod(np.diff(places), 1.0))])
    number = np.arange(-k, 2 * k + 1)
    turns = along[number % k] + number // k
    turns -= np.round(turns[k + lead])
    numbers = number.astype(np.float64)
    ends = monotone_cubic(turns, numbers, np.array([-0.5, 0.0, 0.5]))
    q = np.arange(half + 1) / half
    upper = monotone_cubic(numbers, turns, ends[1] + q * (ends[2] - ends[1]))
    lower = -monotone_cubic(numbers, turns, ends[1] - q * (ends[1] - ends[0]))
    both = 0.5 * (upper + lower)
    both[0], both[-1] = 0.0, 0.5
    out = np.empty(k)
    out[(lead + np.arange(half + 1)) % k] = both
    out[(lead - np.arange(1, half)) % k] = 1.0 - both[1:half]
    return out


def _leading_node(places: Floats) -> int:
    """Return which of nodes at places u (k,), clockwise around a blade, is to be at the leading edge.

    It is the one from which on half of them are nearest to the upper side.
    """
    k = len(places)
    off = np.abs(np.mod(places + 0.5, 1.0) - 0.5)
    lead, trail = int(off.argmin()), int(np.abs(places - 0.5).argmin())
    upper = (trail - lead) % k
    return (lead + round(0.5 * (upper - 0.5 * k))) % k


def at_corners(places: Floats, corners: Floats) -> Floats:
    """Return places u (k,) with the one nearest to each of the `corners` (c,), u too, put there."""
    out = places.copy()
    for corner in corners:
        off = np.abs(np.mod(places - corner + 0.5, 1.0) - 0.5)
        out[int(off.argmin())] = corner
    return out
