"""Places of nodes around a blade, with limited growth of steps at wall and front in all sections."""

import math
from collections.abc import Callable, Sequence

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, wrapped
from meshonet.solvers.layers.even_line import NO_LINKS, Measures, PlaceLinks, evened_places
from meshonet.solvers.rows.across import ChannelLines
from meshonet.solvers.rows.section_plane import SectionPlane

MARGIN = 0.93  # fraction of the logarithm of the largest growth to which steps are limited; nodes still move
SHEAR = 10.0  # square root of the weight of tangents by which lines lean more than before
_TIMES = 4  # evened again while this changes much
_SAME = 1e-9


def even_wall_places(
    planes: Sequence[SectionPlane], places: Floats, corners: Floats, growth: float, pairs: Indices,
    lines: ChannelLines, *, opposite: bool,
) -> Floats:  # fmt: skip
    """Return `places` u (k,), 0 to 1 around the blade, moved until steps grow by about `growth` at most.

    Parameters
    ----------
    corners : (c,) places of nodes that stay.
    pairs : (p, 2) a node of the upper and a node of the lower side, joined by a line across the channel.
    lines : ideal lines across the channel; angles between them and lines of `pairs` should not increase.
    opposite : whether nodes at u and 1 - u stay opposite each other; `lines` then have no effect.
    """
    limit = MARGIN * math.log(growth)
    lead = int(np.abs(wrapped(places)).argmin())
    u = np.roll(places, -lead)
    start = float(np.mod(u[0] + 0.5, 1.0)) - 0.5
    u = start + np.concatenate([[0.0], np.cumsum(np.mod(np.diff(u), 1.0))])
    half = len(u) // 2
    if opposite:
        upper = np.append(u[:half], 0.5)
        corner_sides = np.concatenate([corners, 1.0 - corners])
        upper = _evened(upper, _fixed(upper, corner_sides), _side_measures(planes), limit, closed=False)
        u = np.concatenate([upper[:half], 1.0 - upper[half:0:-1]])
    else:
        fixed = _fixed(u, corners)
        fixed[0] = True
        given, pairs = u, np.mod(pairs - lead, len(u))
        u = _evened(
            u, fixed, _measures(planes), limit, lambda at: lines.links(at, given, pairs, SHEAR), closed=True
        )
    return np.mod(np.roll(u, lead), 1.0)


def _fixed(u: Floats, corners: Floats) -> Bools:
    """Return which places (k,) are at corners or edges."""
    at = np.concatenate([[0.0, 0.5], corners])
    off = wrapped(u[:, None] - at)
    return np.asarray((np.abs(off) < _SAME).any(axis=1))


def _evened(
    u: Floats, fixed: Bools, measures: Measures, limit: float,
    links: Callable[[Floats], PlaceLinks] = lambda _: NO_LINKS, *, closed: bool,
) -> Floats:  # fmt: skip
    for _ in range(_TIMES):
        before, u = u, evened_places(u, fixed, measures, limit, closed, links(u))
        if np.abs(u - before).max() < _SAME:
            break
    return u


def _around(planes: Sequence[SectionPlane]) -> tuple[Floats, Floats]:
    """Return places (m,) from 0 to 1, and relative lengths (k, m) at walls and fronts."""
    u = np.append(planes[0].places, 1.0)
    values = []
    for plane in planes:
        wall = plane.wall_arcs(u)
        length = plane.cascade.ring.front.length
        front = plane.front_arcs(u[:-1])
        steps = np.mod(np.diff(np.append(front, front[0])), length)
        values += [wall / wall[-1], np.concatenate([[0.0], np.cumsum(steps)]) / length]
    return u, np.array(values)


def _measures(planes: Sequence[SectionPlane]) -> Measures:
    u, values = _around(planes)
    return Measures(u, values)


def _side_measures(planes: Sequence[SectionPlane]) -> Measures:
    u, values = _around(planes)
    q = np.unique(np.concatenate([u[u <= 0.5], 1.0 - u[u >= 0.5]]))
    rows = []
    for row in values:
        rows += [np.interp(q, u, row), row[-1] - np.interp(1.0 - q, u, row)]
    return Measures(q, np.array(rows))
