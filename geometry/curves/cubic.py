"""Cubic splines through tables of values at any knots, also such that do not overshoot."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.monotone import hermite_piece, piece_at
from meshonet.kernels._native import cubic_values, sampled_lines, solve_tridiagonal


class CubicTable:
    """The cubic spline through `values` (n, ...) at ascending `knots` (n,), with not-a-knot ends.

    Through 2 knots it is a line, through 3 a parabola. At knots it has bitwise the given values. Beyond the
    ends, the outer cubics continue. de Boor, A Practical Guide to Splines (1978), chapter IV.
    """

    def __init__(self, values: Floats, knots: Floats) -> None:
        self.values, self.knots = values, knots
        self.bends = _bends(values.reshape(len(knots), -1), knots).reshape(values.shape)

    def __call__(self, places: Floats) -> Floats:
        """Return the values (p, ...) of the spline at `places` (p,)."""
        n, *shape = self.values.shape
        arrays = (self.knots, self.values.reshape(n, -1), self.bends.reshape(n, -1), places.reshape(-1))
        knots, values, bends, at = (np.ascontiguousarray(each, np.float64) for each in arrays)
        out = np.empty((at.size, values.shape[1]))
        cubic_values(knots, values, bends, at, out)
        return out.reshape(*places.shape, *shape)

    def slope(self, places: Floats) -> Floats:
        """Return the derivatives (p, ...) of the spline at `places` (p,)."""
        i, t, h = piece_at(self.knots, places, self.values.ndim)
        start, stop, begin, end = self.values[i], self.values[i + 1], self.bends[i], self.bends[i + 1]
        left = 1.0 - t
        return np.asarray(
            (stop - start) / h + h / 6.0 * ((3.0 * t * t - 1.0) * end - (3.0 * left * left - 1.0) * begin)
        )

    def integrals(self) -> Floats:
        """Return the integrals (n, ...) of the spline from the first knot to each knot."""
        h = np.diff(self.knots).reshape(-1, *(1,) * (self.values.ndim - 1))
        mean, bend = self.values[:-1] + self.values[1:], self.bends[:-1] + self.bends[1:]
        pieces = h * (0.5 * mean - h * h * bend / 24.0)
        return np.concatenate([np.zeros_like(self.values[:1]), np.cumsum(pieces, axis=0)])

    def unit_cubics(self) -> Floats:
        """Return coefficients (4, n - 1, ...), ascending, of each interval's cubic in t from 0 to 1."""
        h = np.diff(self.knots).reshape(-1, *(1,) * (self.values.ndim - 1))
        begin, end = self.bends[:-1] * h**2, self.bends[1:] * h**2
        rise = np.diff(self.values, axis=0)
        first = rise - (2.0 * begin + end) / 6.0
        return np.stack([self.values[:-1], first, begin / 2.0, (end - begin) / 6.0])


def cubic_spline(values: Floats, knots: Floats, places: Floats) -> Floats:
    """Return values at `places` (p,) of the cubic spline through `values` (n, ...) at `knots` (n,).

    >>> knots = np.array([0.0, 1.0, 3.0, 4.0, 6.0])
    >>> float(cubic_spline(knots**3, knots, np.array([2.0]))[0])
    8.0
    """
    return CubicTable(values, knots)(places)


def _bends(values: Floats, knots: Floats) -> Floats:
    """Return the second derivatives (n, m) of the spline at its knots."""
    n = len(knots)
    bends = np.zeros_like(values)
    if n < 3:
        return bends
    h = np.diff(knots)
    slopes = np.diff(values, axis=0) / h[:, None]
    right = 6.0 * np.diff(slopes, axis=0)
    if n == 3:
        bends[:] = right / (3.0 * (h[0] + h[1]))
        return bends
    lower, diagonal, upper = h[:-1].copy(), 2.0 * (h[:-1] + h[1:]), h[1:].copy()
    # the end values are extrapolated linearly from the next two
    diagonal[0] += h[0] * (1.0 + h[0] / h[1])
    upper[0] -= h[0] ** 2 / h[1]
    diagonal[-1] += h[-1] * (1.0 + h[-1] / h[-2])
    lower[-1] -= h[-1] ** 2 / h[-2]
    right = np.ascontiguousarray(right)
    solve_tridiagonal(lower, diagonal, upper, right)
    bends[1:-1] = right
    bends[0] = bends[1] - h[0] / h[1] * (bends[2] - bends[1])
    bends[-1] = bends[-2] + h[-1] / h[-2] * (bends[-2] - bends[-3])
    return bends


class LimitedSpline:
    """The cubic spline through `values` (n, ...) at ascending `knots` (n,), limited to be monotone.

    At extrema, the slope is 0. At other knots, the slope is as in `CubicTable`, but at most three times the
    slope of the straight line to each neighbour. Hyman, SIAM J. Sci. Stat. Comput. 4 (1983) 645-654.
    """

    def __init__(self, values: Floats, knots: Floats) -> None:
        self.values, self.knots = values, knots
        step = np.diff(knots).reshape((-1,) + (1,) * (values.ndim - 1))
        delta = np.diff(values, axis=0) / step
        before, behind = np.concatenate([delta[:1], delta]), np.concatenate([delta, delta[-1:]])
        most = 3.0 * np.minimum(np.abs(before), np.abs(behind))
        slopes = np.clip(CubicTable(values, knots).slope(knots), -most, most)
        self.slopes = np.where((slopes * before > 0.0) & (slopes * behind > 0.0), slopes, 0.0)

    def __call__(self, places: Floats) -> Floats:
        """Return values (p, ...) at places (p,)."""
        i, t, h = piece_at(self.knots, places, self.values.ndim)
        return hermite_piece(
            t, self.values[i], self.values[i + 1], h * self.slopes[i], h * self.slopes[i + 1]
        )


def sampled(lines: Floats, arc: Floats, at: Floats) -> Floats:
    """Return points (k, n, ...) at arc lengths `at` (k, n) on k piecewise cubic `lines` (k, m, ...).

    `arc` (k, m) are the arc lengths of the m nodes; values of `at` are limited to the last of them. The
    tangent at a node is the tangent of a parabola through three nodes.
    """
    points = np.empty((*at.shape, lines.shape[2]))
    lines, arc, at = (np.ascontiguousarray(each) for each in (lines, arc, np.minimum(at, arc[:, -1:])))
    sampled_lines(lines, arc, at, points)
    return points
