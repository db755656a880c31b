"""The collar of a wing on a level around a body: a ring of cells between its section and a rectangle.

::

    theta                             lines leave the section along its normals, with first cells of a given
      ^   +------------------+        height. The corners of the rectangle are ends of lines from nodes near
      |   |  .------.___     |        nose and trailing edge; those between them end at the sides before the
      |   | (          _>    |        nose and behind the trailing edge.
      |   |  '-----''`       |
      |   +------------------+
      +--------------------> s
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.cubic import cubic_spline
from meshonet.geometry.ties import first_least
from meshonet.solvers.rows.columns import arcs_of
from meshonet.solvers.rows.span_spacing import two_sided

_EVEN = 0.3
"""Part of the sides of the rectangle that is divided evenly, not as the root is."""
_NORMAL = 0.12
"""Part of a line's length over which it keeps the direction of the root's normal."""
_SMOOTHED = 6
"""Sweeps by which normals are smoothed around the root."""
_UNBOUNDED = 1e9
"""Length of the last cells of lines, which nothing limits but their growth."""
_FINE = 33
"""Places on a line by which its length is measured."""


@dataclass(frozen=True)
class Rectangle:
    """The rectangle around a root: low and high s, low and high t."""

    front: float
    back: float
    low: float
    high: float


def corner_nodes(root: Floats, box: Rectangle, fewest: int) -> tuple[int, int]:
    """Return how many nodes from the middles of trailing edge and nose lines end at corners of the rectangle.

    There the normals of the root point best at the corners, so that lines are bent least.
    """
    normals, half = _normals(root), (len(root) - 1) // 2
    tried = np.arange(fewest, half // 3 + 1)

    def best(middle: int, s: float) -> int:
        worth = np.zeros(len(tried))
        for t, way in ((box.high, 1), (box.low, -1)):
            at = (middle - way * tried if middle else way * tried) % (2 * half)
            towards = np.array([s, t]) - root[at]
            worth += (normals[at] * towards).sum(axis=1) / np.hypot(*towards.T)
        return int(tried[first_least(range(len(tried)), lambda k: -float(worth[k]))])

    return best(0, box.back), best(half, box.front)


def outer_loop(root: Floats, box: Rectangle, corners: tuple[int, int]) -> Floats:
    """Return the nodes (n, 2) on a rectangle where lines from the nodes of a root (n, 2) end.

    The root runs from the middle of the trailing edge over the side of high t first, and is closed; `corners`
    are those of `corner_nodes`.
    """
    half = (len(root) - 1) // 2
    low, high = np.array([box.back, box.low]), np.array([box.back, box.high])
    edge, nose = corners
    stops = [0, edge, half - nose, half + nose, 2 * half - edge, 2 * half]
    middle = 0.5 * (box.low + box.high)
    ends = [
        (np.array([box.back, middle]), high),
        (high, np.array([box.front, box.high])),
        (np.array([box.front, box.high]), np.array([box.front, box.low])),
        (np.array([box.front, box.low]), low),
        (low, np.array([box.back, middle])),
    ]
    out = np.empty_like(root)
    for (start, stop), (begin, end) in zip(pairwise(stops), ends, strict=True):
        step = np.diff(root[start : stop + 1], axis=0)
        arc = np.concatenate([[0.0], np.cumsum(np.hypot(step[:, 0], step[:, 1]))])
        even = np.linspace(0.0, 1.0, len(arc))
        upright = begin[0] == end[0]
        place = even if upright else (1.0 - _EVEN) * arc / arc[-1] + _EVEN * even
        out[start : stop + 1] = begin + place[:, None] * (end - begin)
    return out


def collar(root: Floats, outer: Floats, cells: int, first: float, growth: float) -> Floats:
    """Return nodes (n, cells + 1, 2) between closed loops (n, 2), with first cells of a given length."""
    normals = _normals(root)
    away = np.hypot(*(outer - root).T)[:, None]
    u = np.linspace(0.0, 1.0, _FINE)
    middle = root + _NORMAL * away * normals
    lines = (
        root[:, None] * ((1.0 - u) ** 2)[:, None]
        + middle[:, None] * (2.0 * u * (1.0 - u))[:, None]
        + outer[:, None] * (u * u)[:, None]
    )
    steps = norms(np.diff(lines, axis=1))
    arcs = arcs_of(steps)
    wanted = two_sided(arcs[:, -1], (first, _UNBOUNDED), growth, cells)
    out = np.empty((len(root), cells + 1, 2))
    for k, line in enumerate(lines):
        out[k] = cubic_spline(line, arcs[k], wanted[k])
    out[:, 0], out[:, -1] = root, outer
    out[-1] = out[0]
    return out


def _normals(loop: Floats) -> Floats:
    """Return unit normals (n, 2) of a closed loop, counter-clockwise, away from its inside, smoothed."""
    ring = loop[:-1]
    after, before = np.roll(ring, -1, axis=0) - ring, ring - np.roll(ring, 1, axis=0)
    tangent = after / np.hypot(*after.T)[:, None] + before / np.hypot(*before.T)[:, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1)
    for _ in range(_SMOOTHED + 1):
        normal /= np.hypot(*normal.T)[:, None]
        normal = 0.5 * normal + 0.25 * (np.roll(normal, 1, axis=0) + np.roll(normal, -1, axis=0))
    normal /= np.hypot(*normal.T)[:, None]
    return np.concatenate([normal, normal[:1]])
