"""Places of nodes around a blade, from hub to casing.

Where the blade ends in a gap, nodes lie opposite each other on both sides, so that blocks inside its outline
are not skew. At the other end they are where lines across the channel are at right angles to the blades. In
between places change linearly with the height.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, wrapped
from meshonet.geometry.threads import in_threads
from meshonet.solvers.rows.across import ChannelLines
from meshonet.solvers.rows.opposite import opposite_places
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.wall_places import even_wall_places


@dataclass(frozen=True, eq=False)
class SpanPlaces:
    """Places of nodes clockwise around a blade.

    Parameters
    ----------
    ends : (k,) u at the hub, and at the casing.
    gaps : whether the blade ends in a gap there, and both sides' places are opposite each other.
    """

    ends: tuple[Floats, Floats]
    gaps: tuple[bool, bool]

    @classmethod
    def of(
        cls, planes: Sequence[SectionPlane], places: Floats, pairs: Indices, gaps: tuple[bool, bool]
    ) -> SpanPlaces:
        """Return the places near those (k,) of the middle one of `planes`, with nodes at its corners.

        `pairs` (p, 2) are nodes on the upper and the lower side that lines across the channel join.
        """
        corners, half = planes[0].corners, len(planes) // 2
        if not any(gaps):
            free = at_corners(places, corners)
            return cls((free, free), gaps)
        near = planes if all(gaps) else planes[: half + 1] if gaps[0] else planes[half:]
        mirrored = opposite_places(places, pairs, ChannelLines.of(near))
        nodes = _opposite_nodes(mirrored, corners)
        mirrored[nodes] = corners
        free = _drawn(places, nodes, corners)
        return cls((mirrored if gaps[0] else free, mirrored if gaps[1] else free), gaps)

    def at(self, height: float) -> Floats:
        """Return the places (k,) at a height, 0 to 1."""
        start, end = self.ends
        return np.asarray(np.mod(start + height * wrapped(end - start), 1.0))

    def evened(self, planes: Sequence[SectionPlane], growth: float, pairs: Indices) -> SpanPlaces:
        """Return places whose steps in all sections grow by a limited ratio."""
        lines, corners = ChannelLines.of(planes), planes[0].corners

        def even(k: int) -> Floats:
            own = even_wall_places(planes, self.ends[k], corners, growth, pairs, lines, opposite=self.gaps[k])
            return at_corners(own, corners)

        evened = in_threads(even, (0,) if self.ends[1] is self.ends[0] else (0, 1))
        return SpanPlaces((evened[0], evened[-1]), self.gaps)


def at_corners(places: Floats, corners: Floats) -> Floats:
    """Return places u (k,) with the one nearest to each of the `corners` (c,), u too, put there."""
    out = places.copy()
    out[corner_nodes(places, corners)] = corners
    return out


def corner_nodes(places: Floats, corners: Floats) -> Indices:
    """Return which of places (k,) are nearest to `corners` (c,)."""
    return np.abs(wrapped(places - corners[:, None])).argmin(axis=1)


def _opposite_nodes(mirrored: Floats, corners: Floats) -> Indices:
    """Return which of places (k,), the same on both sides, are nearest to `corners` (c,).

    Corners of both sides that are within a step of being opposite each other have opposite nodes.
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
    """Return places (k,) with some `nodes` (c,) at `corners` (c,), and those between drawn along in order.

    An edge without corners stays where it is.
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
