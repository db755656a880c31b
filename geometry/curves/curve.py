"""Smooth curves through given points, parametrised by arc length."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, cross2, distinct, read_only
from meshonet.geometry.curves.spline import checked_points, cubics, spline_slopes
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import find_corners
from meshonet.kernels._native import curve_locate, curve_points, curve_slopes, curve_speeds

_STEPS = 8  # parts of an interval in the table of arc length
_GAUSS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)])  # three-point quadrature in each part
_WEIGHTS = np.array([5.0, 8.0, 5.0]) / (18.0 * _STEPS)  # Gauss's, of the whole interval
_INNER = ((np.arange(_STEPS)[:, None] + _GAUSS) / _STEPS).ravel()
_EDGES = np.arange(_STEPS + 1) / _STEPS  # ends of the parts


class Curve:
    """A smooth curve exactly through given points, with a cubic in each interval (`geometry.curves.spline`).

    An open curve has at least 2 `points` (n, 2), a closed curve at least 3. A closed curve may repeat its
    first point at the end. The tangent may jump at corners: the argument `corners` has the indices of points,
    or None to detect them; the attribute `corners` has their arc lengths. Intervals in the mask `straight`
    (intervals,) are straight lines, and so is an interval with two corners. Raises InputError: too few
    points; a point that is not finite or equals its neighbour; a corner out of range.

    >>> square = Curve(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), closed=True)
    >>> square.length, square.corners.tolist()
    (4.0, [0.0, 1.0, 2.0, 3.0])
    >>> square.at(np.array([2.5])).tolist()
    [[0.5, 1.0]]
    """

    points: Floats  # (n, 2) the given points; the first point of a closed curve is not repeated
    length: float  # arc length of the whole curve
    knots: Floats  # (n,) arc length at each given point
    corners: Floats  # arc lengths at the corners
    corner_index: Indices  # indices of the points that are corners
    straight: Bools | None  # (intervals,) whether an interval is straight; None: none is

    def __init__(
        self,
        points: Floats,
        *,
        closed: bool = False,
        corners: Sequence[int] | Indices | None = None,
        straight: Bools | None = None,
    ) -> None:
        self.points = read_only(checked_points(points, "curve", "curve point {}", 2, closed=closed))
        self.closed = closed
        n = len(self.points)
        if corners is None:
            self.corner_index = read_only(find_corners(self.points, closed=closed))
        else:
            self.corner_index = read_only(distinct(np.asarray(corners, dtype=np.intp)))
            if self.corner_index.size and (self.corner_index[0] < 0 or self.corner_index[-1] >= n):
                remedy = "count points from 0"
                raise InputError(f"a curve of {n} points has no corner {self.corner_index[-1]}", remedy)
        self.straight = straight
        ends = np.concatenate([self.points, self.points[:1]]) if closed else self.points
        chord = np.diff(ends, axis=0)
        h = np.hypot(chord[:, 0], chord[:, 1])[:, None]
        tangent = None
        if closed and straight is not None and straight.any() and not straight.all():
            from meshonet.geometry.polygon.straights import straight_intervals

            tangent = straight & straight_intervals(self.points, self.corner_index)
        start, stop = spline_slopes(self.points, closed=closed, corners=self.corner_index, tangent=tangent)
        first, last = h * start, h * stop
        if straight is not None:
            along = straight[:, None]
            first, last = np.where(along, chord, first), np.where(along, chord, last)
        self._cubic = cubics(ends[:-1], chord, first, last)
        # tables of arc length and of the slopes of its inverse
        inner, speed = np.empty((len(h), len(_INNER))), np.empty((len(h), len(_EDGES)))
        curve_speeds(self._cubic, _INNER, inner)
        curve_speeds(self._cubic, _EDGES, speed)
        pieces = product(inner.reshape(-1, 3), _WEIGHTS)
        self._table: Floats = np.concatenate([[0.0], np.cumsum(pieces)])
        # dt/ds in units of a part; at most 3 keeps the inverse monotone
        rate = pieces.reshape(-1, _STEPS) * _STEPS
        self._rate_start = np.minimum(rate / np.maximum(speed[:, :-1], 1e-300), 3.0).ravel()
        self._rate_stop = np.minimum(rate / np.maximum(speed[:, 1:], 1e-300), 3.0).ravel()
        self.length = float(self._table[-1])
        self.knots = read_only(self._table[::_STEPS][: len(self.points)].copy())
        self.corners = read_only(self.knots[self.corner_index])

    def reversed(self) -> Curve:
        """Return the closed curve in the other direction, from its last point."""
        corners = np.sort(len(self.points) - 1 - self.corner_index)
        straight = None if self.straight is None else np.roll(self.straight[::-1], -1)
        return Curve(self.points[::-1], closed=True, corners=corners, straight=straight)

    def moved(self, shift: Floats) -> Curve:
        """Return the curve moved by `shift` (2,)."""
        curve = copy(self)
        curve.points = read_only(self.points + shift)
        ends = np.concatenate([curve.points, curve.points[:1]]) if self.closed else curve.points
        curve._cubic = np.concatenate([ends[None, :-1], self._cubic[1:]])
        return curve

    @property
    def tables(self) -> tuple[Floats, Floats, Floats, Floats, int]:
        """Tables for C code: coefficients of the cubics, and their parameter as a function of arc length."""
        return self._cubic, self._table, self._rate_start, self._rate_stop, _STEPS

    def _locate(self, s: Floats) -> tuple[Indices, Floats]:
        """Return the interval and the parameter in it (0 to 1) at arc lengths s (m,)."""
        s = np.ascontiguousarray(s, dtype=np.float64)
        i, t = np.empty(s.shape, dtype=np.intp), np.empty(s.shape)
        curve_locate(s, self._table, self._rate_start, self._rate_stop, _STEPS, self.closed, i, t)
        return i, t

    def at(self, s: Floats) -> Floats:
        """Return points (m, 2) at arc lengths `s` (m,), clipped if the curve is open; exact at `knots`."""
        i, t = self._locate(s)
        points = np.empty((len(t), 2))
        curve_points(self._cubic, i, t, self.points[0 if self.closed else -1], points)
        return points

    def tangent(self, s: Floats) -> Floats:
        """Return unit tangents (m, 2) at arc lengths `s` (m,); at a corner, the tangent after it."""
        i, t = self._locate(s)
        d = np.empty((len(t), 2))
        curve_slopes(self._cubic, i, t, d)
        return np.asarray(d / np.hypot(d[:, 0], d[:, 1])[:, None])

    def polyline(self, places: Floats) -> Floats:
        """Return, for every interval, the points at the parameters `places` (k,) in [0, 1).

        The result is (intervals * k, 2). An open curve has one more row, its end point.
        """
        i = np.arange(self._cubic.shape[1])[:, None]
        t = places[None, :, None]
        a, b, c, d = self._cubic[:, i]
        points = np.asarray((a + t * (b + t * (c + t * d))).reshape(-1, 2))
        return points if self.closed else np.concatenate([points, self.points[-1:]])

    def departure(self) -> float:
        """Return the largest distance of the curve from the polygon through its points."""
        ends = np.concatenate([self.points, self.points[:1]]) if self.closed else self.points
        starts, ways = ends[:-1, None], np.diff(ends, axis=0)[:, None]
        parts = self.polyline(_EDGES[:-1])[: len(ways) * _STEPS].reshape(len(ways), _STEPS, 2) - starts
        return float((np.abs(cross2(ways, parts)) / np.hypot(ways[..., 0], ways[..., 1])).max())


def wall_line(nodes: Floats) -> Curve:
    """Return the open curve through `nodes` (n, 2) of a wall; slight kinks count as corners too."""
    from meshonet.geometry.polygon.straights import find_kinks  # which most curves do not need

    return Curve(nodes, corners=np.concatenate([find_corners(nodes), find_kinks(nodes, few=0)]))
