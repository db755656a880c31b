"""Places of nodes around a blade that are opposite each other on both sides."""

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, wrapped
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.ties import first_least
from meshonet.solvers.rows.across import ChannelLines

FARTHEST = 0.2
"""Largest move of a node around the blade; with larger ones, lines along the span fold around its edges."""


def opposite_places(places: Floats, pairs: Indices, lines: ChannelLines) -> Floats:
    """Return places u (k,) of nodes clockwise around a blade; for each node at u there is one at 1 - u.

    u is 0 at the leading edge and 0.5 at the trailing edge. k is even. Grid lines across the channel join the
    nodes of `pairs` (p, 2), from a blade's upper side to the next blade's lower side. The first pair is
    nearest to the leading edge. The result makes these grid lines as similar as possible to `lines`, which
    are nearly normal to both blades. If possible, no node moves farther than `FARTHEST` from `places` (k,).
    """
    both = _both_sides(places)
    k, half = len(places), len(places) // 2
    around = np.concatenate([both, 1.0 - both[half - 1 : 0 : -1]])
    upper, lower = pairs[0]
    tries = [np.roll(around, lead) for lead in lower + np.arange((upper - lower) % k + 1)]
    moves = np.array([np.abs(wrapped(each - places)).max() for each in tries])
    near = np.flatnonzero(moves <= max(FARTHEST, float(moves.min())))
    return first_least([tries[k] for k in near], key=lambda each: lines.leaning(each, pairs))


def _both_sides(places: Floats) -> Floats:
    """Return places u (k / 2 + 1,), from 0 to 0.5: means of both sides."""
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
    return np.asarray(both)


def _leading_node(places: Floats) -> int:
    """Return which of the nodes at places u (k,), clockwise, shall be at the leading edge.

    The half of the nodes that begins there is nearest to the upper side.
    """
    k = len(places)
    off = np.abs(wrapped(places))
    lead, trail = int(off.argmin()), int(np.abs(places - 0.5).argmin())
    upper = (trail - lead) % k
    return (lead + round(0.5 * (upper - 0.5 * k))) % k
