"""The collar of a wing on a level around a body: a ring of cells between its section and a rectangle.

Lines are those of an elliptic grid, turned to the normals of the section. Lines from nodes near nose and
trailing edge end at the corners of the rectangle.
"""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, arc_lengths, norms, rolled
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.cubic import CubicTable, cubic_spline
from meshonet.geometry.elementary import exp, power
from meshonet.geometry.polygon.normals import left_normals
from meshonet.geometry.ties import first_least
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.rows.columns import arcs_of
from meshonet.solvers.rows.span_spacing import smooth_arcs
from meshonet.solvers.stacking.tip import least_sine

MARGIN = 0.28
"""Smallest distance of the rectangle from the section in chords, on long bodies; more near the tip."""
_SHARE = 0.5  # largest fraction of the way from the section to nose, tail, keel or crown that a collar takes
_SHORTEST = 0.35  # smallest ratio of cells on the short sides of the rectangle to those on its long sides
_SHIFT = 0.3  # largest shift of the middle of a short side towards nose or trailing edge, in half its length
_NORMAL = 0.05  # fraction of a line's length over which the line is turned to the normal of the root
_BENT = 0.12  # fraction of the length of a parabola over which it keeps the direction of the normal
_ON_ROWS = 0.65  # weight of the elliptic grid's rows in the cell sizes in the middle of the collar
_FINE = 33  # number of nodes on the lines of the elliptic grid
_MIRROR = np.array([1.0, -1.0])  # reflection to the plane of a `Boundary`, which runs clockwise

Within: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""Smallest and largest s, smallest and largest theta."""


@dataclass(frozen=True)
class Rectangle:
    """A rectangle around the section of a wing, with sides along and around the body; its four limits."""

    front: float
    back: float
    low: float
    high: float


def rectangle(section: Floats, within: Within, scale: Floats) -> Rectangle:
    """Return a rectangle around a wing's `section` (n, 2), in the coordinates s and theta of `BodyMap`.

    On each side, it takes at most half of the space between the section and the limits `within`. `scale` (2,)
    are the lengths in space of a unit of s and of theta.
    """
    (front, low), (back, high) = (section * scale).min(axis=0), (section * scale).max(axis=0)
    (begin, end), (bottom, top) = (
        [each * float(unit) for each in ends] for ends, unit in zip(within, scale, strict=True)
    )
    margin = MARGIN * (back - front)
    ways = [way * _SHARE for way in (front - begin, end - back, low - bottom, top - high)]
    margin = max(margin, math.sqrt(margin * min(ways)))
    before, behind, below, above = (min(margin, way) for way in ways)
    return Rectangle(float(front - before), float(back + behind), float(low - below), float(high + above))


def corner_nodes(root: Floats, box: Rectangle, fewest: int) -> tuple[int, int]:
    """Return which nodes of a wing's section are joined by grid lines to the corners of the rectangle `box`.

    The first number counts nodes from the middle of the trailing edge: there, lines to the rear corners
    begin. The second counts nodes from the nose: there, lines to the front corners begin. Both are at least
    `fewest`. `root` (n, 2) has two coordinates of each node: its distance along the body, and around it.
    """
    normals, half = _normals(root), (len(root) - 1) // 2
    tried = np.arange(fewest, half // 3 + 1)
    short = 0.5 * (box.high - box.low) / tried  # cells on the short sides
    long = (box.back - box.front) / (half - 2 * tried)
    even = np.flatnonzero((short <= long) & (short >= _SHORTEST * long))
    tried = tried[even] if len(even) else tried[np.abs(short / long - 1.0).argmin()][None]

    def best(middle: int, s: float) -> int:
        worth = np.zeros(len(tried))
        for t, way in ((box.high, 1), (box.low, -1)):
            at = (middle - way * tried if middle else way * tried) % (2 * half)
            towards = np.array([s, t]) - root[at]
            worth += (normals[at] * towards).sum(axis=1) / np.hypot(*towards.T)
        return int(tried[first_least(range(len(tried)), lambda k: -float(worth[k]))])

    return best(0, box.back), best(half, box.front)


def outer_cells(box: Rectangle, corners: tuple[int, int]) -> tuple[float, float]:
    """Return the cell lengths at the rear and at the front of `box`, which have 2 * `corners` equal cells."""
    edge, nose = corners
    return (box.high - box.low) / (2 * edge), (box.high - box.low) / (2 * nose)


def outer_loop(root: Floats, box: Rectangle, corners: tuple[int, int]) -> Floats:
    """Return n nodes on the rectangle `box`, one for each of the n nodes `root` of a wing's section.

    Nodes (n, 2) are distances along and around the aircraft's body. The first half of `root` runs from the
    middle of the trailing edge along the upper side to the nose. For `corners` see `corner_nodes`.
    """
    half = (len(root) - 1) // 2
    edge, nose = corners
    behind, before = outer_cells(box, corners)
    length = np.array([box.back - box.front])
    side = smooth_arcs(length, (behind, before), half - edge - nose)[0]
    middle = 0.5 * (box.low + box.high)
    up, down = np.linspace(middle, box.high, edge + 1), np.linspace(box.high, middle, nose + 1)
    top = np.stack([box.back - side, np.full(len(side), box.high)], axis=1)
    out = np.concatenate(
        [
            np.stack([np.full(edge, box.back), up[:-1]], axis=1),
            top,
            np.stack([np.full(nose, box.front), down[1:]], axis=1),
        ]
    )
    lower = out[-2::-1] * [1.0, -1.0] + [0.0, box.low + box.high]
    out = np.concatenate([out, lower])
    out[edge], out[half - nose] = (box.back, box.high), (box.front, box.high)
    out[-1 - edge], out[half + nose] = (box.back, box.low), (box.front, box.low)
    out[half - nose : half + nose + 1, 0] = box.front
    out[edge : half - nose + 1, 1], out[half + nose : len(out) - edge, 1] = box.high, box.low
    for side, towards in ((out[:, 0] == box.back, root[0]), (out[:, 0] == box.front, root[half])):
        out[side, 1] = _shifted(out[side, 1], box, float(towards[1]))
    return out


def _shifted(places: Floats, box: Rectangle, towards: float) -> Floats:
    """Return places (n,) on a short side of a rectangle, its middle moved `towards` a place."""
    middle, half = 0.5 * (box.low + box.high), 0.5 * (box.high - box.low)
    t = (places - middle) / half
    share = min(max((towards - middle) / half, -_SHIFT), _SHIFT)
    return np.where(np.abs(t) < 1.0, middle + half * (t + share * (1.0 - t * t)), places)


def collar(
    root: Floats, outer: Floats, rows: int, first: float, last: Floats, straight: float = 0.0
) -> tuple[Floats, float]:
    """Return a grid between two closed loops, and the sine of the smallest angle in its first approximation.

    The nodes (n, rows + 1, 2) are on the lines of this approximation, from `root` to `outer` (n, 2).

    Parameters
    ----------
    first, last : lengths of cells at the root, and (n,) at the outer loop.
    straight : from 0 (lines as in an elliptic grid) to 1 (nearly straight lines, normal to the root).
    """
    arcs, lines = _lines(root, outer, straight)
    wanted = _rows(arcs, rows, first, last)
    out = np.empty((len(root), rows + 1, 2))
    for k, line in enumerate(lines):
        out[k] = cubic_spline(line, arcs[k], wanted[k])
    begin = 4.0 * lines[:, 1] - 3.0 * lines[:, 0] - lines[:, 2]
    turn = _normals(root) - begin / norms(begin)[:, None]
    fade = 1.0 - wanted / wanted[:, -1:]
    way = _NORMAL * wanted[:, -1:]
    out += turn[:, None] * (wanted * exp(-wanted / way) * fade * fade)[..., None]
    out[:, 0], out[:, -1] = root, outer
    out[-1] = out[0]
    return out, least_sine(np.pad(lines[::-1], ((0, 0), (0, 0), (0, 1))))


def _rows(arcs: Floats, rows: int, first: float, last: Floats) -> Floats:
    """Return arcs (n, rows + 1) of nodes on lines with arcs (n, m) of the elliptic grid.

    In the middle of the collar nodes are nearly on rows of that grid, which turn corners smoothly.
    """
    own = smooth_arcs(arcs[:, -1], (first, last), rows)
    mean = own.mean(axis=0)
    even = np.linspace(0.0, 1.0, arcs.shape[1])
    at = cubic_spline(even, arcs.mean(axis=0), mean)
    at[-1] = 1.0
    level = CubicTable(arcs.T, even)(at).T
    t = np.linspace(0.0, 1.0, rows)
    steps = np.diff(own) * power(np.diff(level) / np.diff(own), _ON_ROWS * 4.0 * t * (1.0 - t))
    steps *= ((arcs[:, -1] - first) / steps[:, 1:].sum(axis=1))[:, None]
    steps[:, 0] = first
    wanted = arcs_of(steps)
    wanted[:, -1] = arcs[:, -1]
    return wanted


def lengths(root: Floats, outer: Floats) -> Floats:
    """Return the lengths (n,) of the lines that join the nodes of the loops `root` and `outer` (n, 2)."""
    return _lines(root, outer)[0][:, -1]


def _lines(root: Floats, outer: Floats, straight: float = 0.0) -> tuple[Floats, Floats]:
    """Return arc lengths (n, m) and points (n, m, 2) of the lines of a collar."""
    u = np.linspace(0.0, 1.0, _FINE)[:, None]
    cut = root[0] + (outer[0] - root[0]) * u
    cut[0], cut[-1] = root[0], outer[0]
    south, north, west = (side * _MIRROR for side in (root, outer, cut))
    lines = np.ascontiguousarray(solve(Boundary(south, north, west, west, "o")).grid.nodes * _MIRROR)
    if straight:
        middle = root + _BENT * norms(outer - root)[:, None] * _normals(root)
        ends = root[:, None] * (1.0 - u) ** 2 + outer[:, None] * u**2
        lines += straight * (ends + middle[:, None] * (2.0 * u * (1.0 - u)) - lines)
    return arc_lengths(lines), lines


def _normals(loop: Floats) -> Floats:
    """Return smoothed outward unit normals (n, 2) of a closed counter-clockwise loop."""
    normal = -left_normals(loop[:-1])
    normal = 0.5 * normal + 0.25 * (rolled(normal, 1) + rolled(normal, -1))
    normal /= np.hypot(*normal.T)[:, None]
    return np.concatenate([normal, normal[:1]])
