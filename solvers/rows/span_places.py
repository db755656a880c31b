"""Places of nodes around a blade, linear in the height from hub to casing.

At an end with a gap, nodes on both sides of a blade are opposite each other. At other ends, nodes move if
grid lines across the channel lean too far from the normal of the blades.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, smooth_step, wrapped
from meshonet.geometry.threads import in_threads
from meshonet.solvers.rows.across import ChannelLines
from meshonet.solvers.rows.opposite import opposite_places
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.wall_places import even_wall_places

BASE = 7  # smallest number of cells between the two corners of a blunt edge
_NEAR_EDGE = 0.1  # places from an edge up to which corners are its own
LEAN = 1.1  # tangent of the largest angle between a line and the normal at which places stay
_ROUNDS = 3  # places opposite each other are not linear in u
_RIDGE = 0.05  # weight of displacements, relative to the mean weight of lines
_OPPOSITE = 0.3  # fraction of the mean weight of lines above which two places count as opposite each other
_TAPER = 0.15  # of the lines, at both ends of the channel, in which moves die out
_TINY = 1e-300  # in place of 0 in divisors
_LEAST = 0.35  # smallest ratio of a step between neighbouring nodes to the same step before


@dataclass(frozen=True, eq=False)
class SpanPlaces:
    """Places of k nodes, from 0 to 1 around a blade, which change linearly from hub to casing."""

    ends: tuple[Floats, Floats]  # places u (k,) at the hub and at the casing
    gaps: tuple[bool, bool]  # whether the blade ends there in a gap; then each node at u has one at 1 - u

    @classmethod
    def of(
        cls, planes: Sequence[SectionPlane], places: Floats, pairs: Indices, gaps: tuple[bool, bool]
    ) -> "SpanPlaces":
        """Return places (positions of nodes around a blade) with a node at each corner of its outline.

        Parameters
        ----------
        planes : all sections along the span.
        places : (k,) places in the middle section, from which the result deviates little.
        pairs : (p, 2) a node on the upper side, and its partner on the next blade's lower side.
        gaps : whether there is a gap at the hub, and at the casing.
        """
        corners, half = planes[0].corners, len(planes) // 2
        if any(gaps):
            near = planes if all(gaps) else planes[: half + 1] if gaps[0] else planes[half:]
            mirrored = opposite_places(places, pairs, ChannelLines.of(near))
            nodes, mirrored = _with_corners(mirrored, _opposite_nodes(mirrored, corners), corners)
            free = _drawn(places, nodes, corners)
        else:
            nodes, free = _with_corners(places, corner_nodes(places, corners), corners)
            mirrored = free
        ends = mirrored if gaps[0] else free, mirrored if gaps[1] else free
        if not all(gaps):
            fixed = np.zeros(len(places), dtype=bool)
            fixed[nodes] = True
            ends = upright(ends, (not gaps[0], not gaps[1]), planes, pairs, fixed)
        return cls(ends, gaps)

    def at(self, height: float) -> Floats:
        """Return the nodes' places (k,), 0 to 1 around the blade, at a height from hub (0) to casing (1)."""
        start, end = self.ends
        return np.asarray(np.mod(start + height * wrapped(end - start), 1.0))

    def evened(self, planes: Sequence[SectionPlane], growth: float, pairs: Indices) -> "SpanPlaces":
        """Return places with which cells along the blade grow by at most `growth`; `pairs` are as in `of`."""
        lines, corners = ChannelLines.of(planes), planes[0].corners

        def even(k: int) -> Floats:
            own = even_wall_places(planes, self.ends[k], corners, growth, pairs, lines, opposite=self.gaps[k])
            return at_corners(own, corners)

        evened = in_threads(even, (0,) if self.ends[1] is self.ends[0] else (0, 1))
        return SpanPlaces((evened[0], evened[-1]), self.gaps)


def at_corners(places: Floats, corners: Floats) -> Floats:
    """Return `places` (k,), 0 to 1 around a blade, with those nearest to `corners` (c,) replaced by these."""
    out = places.copy()
    out[corner_nodes(places, corners)] = corners
    return out


def corner_nodes(places: Floats, corners: Floats) -> Indices:
    """Return the indices (c,) of the places (k,) nearest to `corners` (c,)."""
    return np.abs(wrapped(places - corners[:, None])).argmin(axis=1)


def _with_corners(places: Floats, nodes: Indices, corners: Floats) -> tuple[Indices, Floats]:
    """Return the nodes at `corners` (c,), some farther apart, and places (k,) with these."""
    wide = _widened(nodes, corners, len(places))
    out = places.copy() if (wide == nodes).all() else _drawn(places, wide, corners)
    out[wide] = corners
    return wide, out


def _widened(nodes: Indices, corners: Floats, count: int) -> Indices:
    """Return the nodes (c,) at `corners` (c,), with `BASE` cells or more at cut edges."""
    out = nodes.copy()
    for edge in (0.0, 0.5):
        off = wrapped(corners - edge)
        near = np.flatnonzero((np.abs(off) < _NEAR_EDGE) & (off != 0.0))
        if len(near) == 2:
            first, last = near[np.argsort(off[near], kind="stable")]
            cells = (nodes[last] - nodes[first]) % count
            more = max(0, math.ceil(0.5 * (BASE - cells)))
            out[first] = (nodes[first] - more) % count
            out[last] = (nodes[last] + more) % count
    return out


def _opposite_nodes(mirrored: Floats, corners: Floats) -> Indices:
    """Return which of symmetric places (k,) are nearest to `corners` (c,), opposite ones if possible."""
    nodes = corner_nodes(mirrored, corners)
    lead = int(np.abs(wrapped(mirrored)).argmin())
    upper, lower = np.flatnonzero(corners < 0.5), np.flatnonzero(corners > 0.5)
    for k in lower if len(upper) else ():
        other = upper[int(np.abs(corners[upper] + corners[k] - 1.0).argmin())]
        opposite = (2 * lead - nodes[other]) % len(mirrored)
        if (nodes[k] - opposite + 1) % len(mirrored) <= 2:
            nodes[k] = opposite
    return nodes


def _drawn(places: Floats, nodes: Indices, corners: Floats) -> Floats:
    """Return places (k,) with `nodes` (c,) at `corners` (c,), and those between drawn along."""
    if not len(nodes):
        return places
    move = wrapped(corners - places[nodes])
    for edge in (0.0, 0.5):
        if np.abs(wrapped(corners - edge)).min() > 0.25:
            nodes, move = np.append(nodes, corner_nodes(places, np.array([edge]))), np.append(move, 0.0)
    drawn = places + np.interp(places, places[nodes], move, period=1.0)
    drawn = np.mod(drawn, 1.0)
    drawn[nodes[: len(corners)]] = corners
    return np.asarray(drawn)


def upright(
    ends: tuple[Floats, Floats], free: tuple[bool, bool], planes: Sequence[SectionPlane], pairs: Indices,
    fixed: Bools,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return places of a blade's nodes, at hub and casing, changed so that lines to the next blade lean less.

    Lines lean if they are not normal to the blade's wall layers. Nodes stay on their side of the blade.

    Parameters
    ----------
    ends : given places (k,), from 0 to 1 around the blade, at the hub and at the casing.
    free : whether places at the hub may move, and whether places at the casing may.
    planes : sections of the blade along the span.
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
    """Return places (k,), `pairs` (p, 2) moved apart by `moves` (p,), those between drawn along."""
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
