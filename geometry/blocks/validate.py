"""Checks that the edges of a boundary neither cross nor touch: if they do, it encloses no valid grid.

::

    quad   one closed line: south, east, north, west      o   two: the body, and the far field around it
    c      three: the body, its wake, and west, north and east around both

Lines may meet where they share a node by construction, such as a body and its wake. Opposite sides of a quad
may also coincide, as the cut of a grid that goes all the way round.
"""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.connection import wake_nodes
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import contains
from meshonet.geometry.polygon.self_intersection import Crossing, find_crossings

if TYPE_CHECKING:
    from meshonet.geometry.blocks.boundary import Boundary

REMEDY = "correct these points: no grid can be made inside edges that cross"
_MOST = 4096  # crossings examined; those at common ends of lines are among them and do not count
_SEAM = 1e-6  # largest distance of opposite sides that coincide, divided by the length of their shortest cell


def check_edges(boundary: Boundary) -> None:
    """Raise InputError, with the position, if edges cross or touch, or if a body is outside its far field."""
    if not boundary.around_body and not find_crossings(boundary.outline(), limit=1):
        return
    lines = _lines(boundary)
    path = np.concatenate(lines)
    joints = np.cumsum(list(map(len, lines[:-1])), dtype=np.intp) - 1  # segments between two lines
    ends = path[np.concatenate([[0], joints, joints + 1, [-1]])]
    crossings = find_crossings(path, closed=False, limit=_MOST)
    for crossing in sorted(crossings, key=attrgetter("first", "second")):
        if crossing.first in joints or crossing.second in joints or _shares_end(path, crossing, ends):
            continue
        raise InputError(_where(boundary, path, crossing), REMEDY)
    if len(lines) > 1 and boundary.around_body and not contains(lines[-1], lines[0][0]):
        x, y = lines[0][0]
        outside = f"the body, at ({x:.6g}, {y:.6g}), lies outside its far field"
        raise InputError(outside, "use a far field around the body")


def _lines(boundary: Boundary) -> list[Floats]:
    """Return lines (n, 2) that may not cross, the outermost last."""
    south, north, west, east = boundary.south, boundary.north, boundary.west, boundary.east
    if boundary.periodic or _coincide(west, east):
        return [south, north]
    wake = boundary.wake or max(wake_nodes(south) - 1, 0)  # a quad may have a cut that was not declared
    if wake:
        outer = np.concatenate([west, north[1:], east[-2::-1]])
        return [south[wake : len(south) - wake], south[: wake + 1], outer]
    if _coincide(south, north):
        return [west, east]
    outline = boundary.outline()
    return [np.concatenate([outline, outline[:1]])]


def _coincide(a: Floats, b: Floats) -> bool:
    step = float(np.abs(np.diff(a, axis=0)).sum(axis=1).min())
    return bool(np.abs(a - b).max() <= _SEAM * step)


def _shares_end(path: Floats, crossing: Crossing, ends: Floats) -> bool:
    """Return whether two segments have only a node in common, which is one of the `ends` of lines."""
    (a, b), (c, d) = path[crossing.first : crossing.first + 2], path[crossing.second : crossing.second + 2]
    shared = []
    for p, q in ((a, b), (b, a)):
        for r, s in ((c, d), (d, c)):
            if (p == r).all():
                shared.append((p, q - p, s - p))
    if len(shared) != 1:
        return False
    ((at, u, v),) = shared
    return bool((at == ends).all(axis=1).any() and (u[0] * v[1] != u[1] * v[0] or product(u, v) < 0))


def _where(boundary: Boundary, path: Floats, crossing: Crossing) -> str:
    """Return as text which edges cross, after which of their nodes, and where."""
    (a, k), (b, m) = (_place(boundary, path[n : n + 2]) for n in (crossing.first, crossing.second))
    at = f"({crossing.x:.6g}, {crossing.y:.6g})"
    if a == b:
        return f"{a} crosses itself at {at}, behind its nodes {min(k, m)} and {max(k, m)}"
    return f"{a} and {b} cross at {at}, behind node {k} of {a} and node {m} of {b}"


def _place(boundary: Boundary, segment: Floats) -> tuple[str, int]:
    """Return the side that a segment (2, 2) lies on, and the index of its first node there."""
    for side in SIDES:
        edge = getattr(boundary, side)
        for way in (segment, segment[::-1]):
            begins = (edge[:-1] == way[0]).all(axis=1) & (edge[1:] == way[1]).all(axis=1)
            if begins.any():
                return side, int(np.argmax(begins))
    return "the boundary", 0  # never reached: lines consist of sides
