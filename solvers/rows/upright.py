"""Places of nodes around a blade, at ends without a gap, with which lines across the channel lean less.

Opposite places change from hub to casing, as does the ratio of length to width of a channel that turns
outwards.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, smooth_step, wrapped
from meshonet.solvers.rows.across import ChannelLines
from meshonet.solvers.rows.section_plane import SectionPlane

LEAN = 1.1  # tangent of the largest angle between a line and the normal at which places stay
_ROUNDS = 3  # places opposite each other are not linear in u
_RIDGE = 0.05  # weight of displacements, relative to the mean weight of lines
_OPPOSITE = 0.3  # fraction of the mean weight of lines above which two places count as opposite each other
_TAPER = 0.15  # of the lines, at both ends of the channel, in which moves die out
_TINY = 1e-300  # in place of 0 in divisors
_LEAST = 0.35  # smallest ratio of a step between neighbouring nodes to the same step before


def upright(
    ends: tuple[Floats, Floats], free: tuple[bool, bool], planes: Sequence[SectionPlane], pairs: Indices,
    fixed: Bools,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return places u (k,) at hub and casing with which lines across the channel lean less.

    No node moves beyond an edge of the blade. No node moves at all if, in the half of the span at a free end,
    no line leans by more than `LEAN`.

    Parameters
    ----------
    ends : given places (k,) at hub and casing.
    free : whether the places at the hub may move, and at the casing.
    pairs : (p, 2) the two nodes that each line joins, on the upper side and on the next blade's lower side.
    fixed : (k,) mask of nodes that do not move.
    """
    heights = np.array([plane.height for plane in planes])
    parts = np.stack([1.0 - heights, heights], axis=1)[:, free]
    near = (parts >= 0.5).any(axis=1)
    lines = [ChannelLines.of([plane]) for plane in planes]
    t = np.linspace(0.0, 1.0, len(pairs))
    taper = smooth_step(np.clip(np.minimum(t, 1.0 - t) / _TAPER, 0.0, 1.0))
    made = list(ends)
    for _ in range(_ROUNDS):
        missing, weights = np.empty((2, len(planes), len(pairs)))
        for k, (line, height) in enumerate(zip(lines, heights.tolist(), strict=True)):
            at = np.mod(made[0] + height * wrapped(made[1] - made[0]), 1.0)[pairs]
            missing[k], weights[k] = _missing(line, at)
        if not missing[near].any():
            break
        moves = taper * _fitted(parts, missing, weights)
        seen = weights.mean(axis=0) > _OPPOSITE * weights.mean()
        for own, move in zip(np.flatnonzero(free).tolist(), moves, strict=True):
            made[own] = _moved(made[own], pairs[seen], move[seen], fixed)
    return made[0], made[1]


def _missing(line: ChannelLines, pairs: Floats) -> tuple[Floats, Floats]:
    """Return how far pairs (p, 2) of places must move for lines to lean little, and weights."""
    weights, off = line.weights(pairs), -line.aside(pairs)
    little = LEAN / np.sqrt(np.where(weights > 0.0, weights, 1.0))
    return np.where(weights > 0.0, off - np.clip(off, -little, little), 0.0), weights


def _fitted(parts: Floats, missing: Floats, weights: Floats) -> Floats:
    """Return moves (e, p) whose combinations by `parts` (q, e) best match `missing` (q, p)."""
    ridge = _RIDGE * weights.mean() * len(parts)
    squares = (parts[:, :, None] ** 2 * weights[:, None]).sum(axis=0) + ridge
    right = (parts[:, :, None] * (weights * missing)[:, None]).sum(axis=0)
    if len(squares) == 1:
        return np.asarray(right / squares)
    mixed = (parts.prod(axis=1)[:, None] * weights).sum(axis=0)
    return np.asarray((right * squares[::-1] - right[::-1] * mixed) / (squares.prod(axis=0) - mixed**2))


def _moved(places: Floats, pairs: Indices, moves: Floats, fixed: Bools) -> Floats:
    """Return places (k,), `pairs` (p, 2) moved apart by `moves` (p,), those between drawn along.

    The one farther from an edge moves more.
    """
    room = 0.25 - np.abs(0.25 - np.abs(wrapped(places[pairs])))
    share = room / np.maximum(room.sum(axis=1, keepdims=True), _TINY)
    stay = np.concatenate([[0.0, 0.5], places[fixed]])
    at = np.concatenate([stay, places[pairs].ravel()])
    move = np.concatenate([np.zeros(len(stay)), (-share * moves[:, None]).ravel()])
    at, first = np.unique(at, return_index=True)
    shift = np.interp(places, at, move[first], period=1.0)
    steps = np.mod(np.diff(places, append=places[:1]), 1.0)
    shrunk = float((-np.diff(shift, append=shift[:1]) / steps).max())
    if shrunk > 1.0 - _LEAST:
        shift *= (1.0 - _LEAST) / shrunk
    return np.asarray(np.mod(places + shift, 1.0))
