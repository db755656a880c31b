"""Places of nodes around a blade, linear in the height from hub to casing.

At an end with a gap both sides have opposite nodes; at other ends lines across the channel are normal to
blades.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, wrapped
from meshonet.geometry.threads import in_threads
from meshonet.solvers.rows.across import ChannelLines
from meshonet.solvers.rows.opposite import opposite_places
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.upright import upright
from meshonet.solvers.rows.wall_places import even_wall_places

BASE = 7  # smallest number of cells between the two corners of a blunt edge
_NEAR_EDGE = 0.1  # places from an edge up to which corners are its own


@dataclass(frozen=True, eq=False)
class SpanPlaces:
    """Places u (see `SectionPlane`) of nodes clockwise around a blade, from hub to casing."""

    ends: tuple[Floats, Floats]  # places u (k,) at the hub and at the casing
    gaps: tuple[bool, bool]  # whether the blade ends there in a gap; then each node at u has one at 1 - u

    @classmethod
    def of(
        cls, planes: Sequence[SectionPlane], places: Floats, pairs: Indices, gaps: tuple[bool, bool]
    ) -> SpanPlaces:
        """Return places near `places` (k,) of the middle section, with a node at each corner.

        Parameters
        ----------
        planes : all sections.
        pairs : (p, 2) nodes on the upper and the lower side that lines across the channel join.
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
        """Return the places (k,) at a height from 0 to 1."""
        start, end = self.ends
        return np.asarray(np.mod(start + height * wrapped(end - start), 1.0))

    def evened(self, planes: Sequence[SectionPlane], growth: float, pairs: Indices) -> SpanPlaces:
        """Return places moved so that steps between nodes grow by about `growth` at most in all sections."""
        lines, corners = ChannelLines.of(planes), planes[0].corners

        def even(k: int) -> Floats:
            own = even_wall_places(planes, self.ends[k], corners, growth, pairs, lines, opposite=self.gaps[k])
            return at_corners(own, corners)

        evened = in_threads(even, (0,) if self.ends[1] is self.ends[0] else (0, 1))
        return SpanPlaces((evened[0], evened[-1]), self.gaps)


def at_corners(places: Floats, corners: Floats) -> Floats:
    """Return `places` u (k,), with the place nearest to each of the `corners` u (c,) moved there."""
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
    """Return which of symmetric places (k,) are nearest to `corners` (c,).

    Corners within a step of being opposite get opposite nodes.
    """
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
    """Return places (k,) with `nodes` (c,) at `corners` (c,), and those between drawn along.

    An edge without corners stays.
    """
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
