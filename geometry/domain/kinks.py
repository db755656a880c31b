"""Kinks of polygons as corners of two cells, so that a grid has a node at each."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Indices, distinct, shortest_ways
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop, turns_sharply
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.polygon.straights import find_kinks

APART = 0.01  # smallest distance of a kink from a corner or another kink, over the length of the loop


def with_kinks(domain: Domain) -> Domain:
    """Return the domain with a corner at each kink of its polygons (see `find_kinks`).

    A grid then has a node there, at which two cells meet, and no cell edge cuts the kink off.
    """
    held = 1 if domain.periodic else 0  # periodic sides are matched already
    loops = domain.loops
    return replace(domain, loops=(*loops[:held], *map(_with_kinks, loops[held:])))


def _with_kinks(loop: Loop) -> Loop:
    straight = loop.curve.straight
    if straight is None or not straight.all() or not loop.corners:
        return loop
    kinks = _kinks(loop)
    if len(kinks) == 0:
        return loop
    corners = distinct(np.append(loop.corners, kinks)).tolist()
    names, cells = loop.names, dict(zip(loop.corners, loop.cells, strict=False))
    if len(names) > 1:
        names = tuple(loop.name_at(float(loop.curve.knots[k])) for k in corners)
    if cells:
        cells |= dict.fromkeys(kinks.tolist(), 2)
    return replace(loop, corners=tuple(corners), names=names, cells=tuple(cells[k] for k in corners if cells))


def _kinks(loop: Loop) -> Indices:
    points, count = loop.curve.points, len(loop.curve.points)
    parts = []
    for begin, end in zip(loop.corners, (*loop.corners[1:], loop.corners[0] + count), strict=True):
        stretch = np.arange(begin, end + 1) % count
        parts.append(stretch[find_kinks(points[stretch])])
    kinks = distinct(np.concatenate(parts))
    kinks = kinks[~turns_sharply(turning(points, closed=True)[kinks])]
    arcs = loop.curve.knots[kinks]
    others = np.concatenate([arcs, loop.corner_arcs])
    way = shortest_ways(others - arcs[:, None], loop.length)
    return kinks[(np.abs(way) < APART * loop.length).sum(axis=1) == 1]  # itself
