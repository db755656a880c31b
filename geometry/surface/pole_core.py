"""A core patch and the rows around it in place of a pole, a side of a patch that is a single point.

The first columns of the fan of curves out of the pole become a core of (a, b) cells; rows around it go over
into the column `at`. The pole is inside, or with a fan of 180 or 90 degrees on a side or at a corner.
"""

import math
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms, smooth_step
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.elementary import arctan2, power

_SIZE = 0.35  # half the width of a core, divided by the arc length from the pole to the column `at`
_ROUNDING = 0.5  # exponent of the map from square to core: 0 keeps the corners, 1 makes a disc's rim
_EVEN = 0.25
"""Constant a of the map x sqrt(1 - a y^2), y sqrt(1 - a x^2) from the square to an even core.

a = 0 keeps the square, 1/2 makes a disc; this value makes corners of 127 degrees, as in other cores.
"""
_NOSE = 0.65  # smallest ratio of a column's width to its distance from the pole, over the largest, on a nose
_FEWEST = 3  # fewest rows between a core and the column `at`, and fewest columns that they replace


@dataclass(frozen=True)
class PoleCore:
    """A block (core) and rows of cells around it, which replace the cells around a pole of a patch.

    Parameters
    ----------
    nodes : (b + 1, a + 1, 3) nodes of the core, oriented as the patch.
    rows : (r, m + 1, 3) lines of nodes around the pole, from the edge of the core outwards.
    at : index, in the patch, of the last line of `rows`; the patch keeps its nodes from there on.
    """

    nodes: Floats
    rows: Floats
    at: int


def core_of(fan: Floats, quarters: int, most: int, *, even: bool = False) -> PoleCore:
    """Return a block (core), and rows of cells around it, that replace the cells around a pole of a patch.

    `fan` (m + 1, n, 3) are the nodes of the patch; those with j = 0 are the pole. Cells beyond j = `most` are
    kept. `quarters` is the angle of the patch around the pole, in right angles. If it is 4, the nodes i = m
    repeat those of i = 0, and m is even. The core's outline is a rounded square. Grid lines of the core
    have kinks, at which cell sizes change by up to a factor of 2, unless it is `even`.
    """
    m = len(fan) - 1
    steps = norms(np.diff(fan, axis=1)).mean(axis=0)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    at = _column(norms(np.diff(fan, axis=0)).mean(axis=0), arc, most)
    y, x = _knots(m, quarters)
    radius, turn = _polar(y, x, quarters, even=even)
    surface = _Fan(fan, arc / arc[at], closed=quarters == 4)
    nodes = surface(_SIZE * radius, turn * m)
    rim = _rim(np.stack([_SIZE * radius, turn], axis=-1), quarters)
    cell = _SIZE * arc[at] * float(y[1] - y[0])
    along, across = _row_places(rim, cell, arc[at], float(steps[min(at, len(steps) - 1)]))
    rows = surface(along, across * m)
    rows[0] = _rim(nodes, quarters)
    return PoleCore(np.swapaxes(nodes, 0, 1), rows, at)


def _column(widths: Floats, arc: Floats, most: int) -> int:
    """Return the column up to which a core replaces a fan, with cells of `widths` (n,) at `arc` (n,).

    It is the first of square cells, or the last on the nose, whose width still grows.
    """
    square = np.flatnonzero(widths[1:most] >= np.diff(arc)[1:most])
    spread = widths[1 : most + 1] / arc[1 : most + 1]
    nose = np.flatnonzero(spread >= _NOSE * spread.max())
    column = min(int(square[0]) + 1 if len(square) else most, int(nose[-1]) + 1)
    return min(max(column, _FEWEST), most)


def _knots(m: int, quarters: int) -> tuple[Floats, Floats]:
    """Return y (a + 1,), rising, and x (b + 1,), falling, of a square's lines, the pole at 0.

    The turn 0 of the fan is the half-line y = 0, x > 0.
    """
    if quarters == 1:
        return np.linspace(0.0, 1.0, m // 2 + 1), np.linspace(1.0, 0.0, m - m // 2 + 1)
    if quarters == 2:
        b = m // 2 + (m - m // 2) % 2
        return np.linspace(0.0, 1.0, (m - b) // 2 + 1), -_both_ways(b)
    return _both_ways(m // 4), -_both_ways(m // 2 - m // 4)


def _both_ways(cells: int) -> Floats:
    """Return knots (cells + 1,) from -1 over 0 to 1."""
    low = cells // 2
    return np.concatenate([np.linspace(-1.0, 0.0, low + 1)[:-1], np.linspace(0.0, 1.0, cells - low + 1)])


def _polar(y: Floats, x: Floats, quarters: int, *, even: bool) -> tuple[Floats, Floats]:
    """Return radii and turns (0 to 1 over the fan) of the nodes (a + 1, b + 1) of a core."""
    y, x = np.broadcast_arrays(y[:, None], x[None])
    if even:
        y, x = y * np.sqrt(1.0 - _EVEN * (x * x)), x * np.sqrt(1.0 - _EVEN * (y * y))
    square, radius = np.maximum(np.abs(x), np.abs(y)), np.sqrt(x * x + y * y)
    turn = arctan2(y, x)
    turn = np.where(turn < 0.0, turn + 2.0 * math.pi, turn) / (0.5 * math.pi * quarters)
    if even:
        return radius, turn
    shrunk = np.divide(square, radius, out=np.ones(square.shape), where=radius > 0.0)
    return radius * power(shrunk, _ROUNDING), turn


def _rim(core: Floats, quarters: int) -> Floats:
    """Return the outer nodes (m + 1, d) of a core (a + 1, b + 1, d), by rising turn."""
    if quarters == 1:
        return np.concatenate([core[:, 0], core[-1, 1:]])
    if quarters == 2:
        return np.concatenate([core[:, 0], core[-1, 1:], core[-2::-1, -1]])
    middle = (len(core) - 1) // 2
    around = (core[middle:, 0], core[-1, 1:], core[-2::-1, -1], core[0, -2::-1], core[1 : middle + 1, 0])
    return np.concatenate(around)


def _row_places(rim: Floats, first: float, length: float, last: float) -> tuple[Floats, Floats]:
    """Return radii and turns (r + 1, m + 1) of rows from the rim (m + 1, 2) of a core to radius 1.

    Sizes go geometrically from `first` to `last`; radius 1 has `length`.
    """
    way = (1.0 - _SIZE) * length
    ratio = last / first
    mean = (last - first) / math.log(ratio) if abs(ratio - 1.0) > 1e-6 else first
    count = max(round(way / mean), _FEWEST)
    steps = power(ratio, np.linspace(0.0, 1.0, count))
    t = np.concatenate([[0.0], np.cumsum(steps)])[:, None]
    t /= t[-1]
    even = np.linspace(0.0, 1.0, len(rim))
    fade = smooth_step(t)
    turn = rim[:, 1].copy()
    turn[-1] = 1.0
    return rim[:, 0] + t * (1.0 - rim[:, 0]), (1.0 - fade) * turn + fade * even


class _Fan:
    """The surface of a fan (m + 1, n, 3): cubic splines along curves, cubics through four across them."""

    def __init__(self, fan: Floats, knots: Floats, *, closed: bool) -> None:
        ahead = fan[1:2] if closed else fan[:0]
        behind = fan[-2:-1] if closed else fan[:0]
        self.curves = CubicTable(np.swapaxes(np.concatenate([behind, fan, ahead]), 0, 1), knots)
        self.before, self.cells = len(behind), len(fan) - 1

    def __call__(self, radius: Floats, place: Floats) -> Floats:
        """Return points (r, s, 3) at radii and places across the curves (r, s)."""
        return np.stack([self._row(*row) for row in zip(radius, place, strict=True)])

    def _row(self, radius: Floats, place: Floats) -> Floats:
        last = self.cells + 2 * self.before
        first = np.clip(np.floor(place).astype(np.intp) + self.before - 1, 0, max(last - 3, 0))
        f = place + self.before - first
        many = min(last + 1, 4)
        out = np.zeros((len(place), 3))
        points = self.curves(radius)
        for k in range(many):
            weight = np.ones(len(place))
            for other in range(many):
                if other != k:
                    weight *= (f - other) / (k - other)
            out += weight[:, None] * points[np.arange(len(place)), first + k]
        return out
