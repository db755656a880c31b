"""Cubic splines through tables of values at any knots."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import solve_tridiagonal


def cubic_spline(values: Floats, knots: Floats, places: Floats) -> Floats:
    """Return the cubic spline (p, ...) through `values` (n, ...) at rising `knots` (n,), at `places` (p,).

    Not-a-knot: the third derivative is continuous at the second and at the last but one knot. 2 knots give a
    straight line, 3 a parabola. Values at knots are bitwise kept. de Boor, A Practical Guide to Splines
    (1978), chapter IV.

    >>> knots = np.array([0.0, 1.0, 3.0, 4.0, 6.0])
    >>> float(cubic_spline(knots**3, knots, np.array([2.0]))[0])
    8.0
    """
    n = len(knots)
    table = values.reshape(n, -1)
    bends = _bends(table, knots)
    first = np.clip(np.searchsorted(knots, places, side="right") - 1, 0, n - 2)
    h = (knots[first + 1] - knots[first])[:, None]
    t = ((places - knots[first]) / h[:, 0])[:, None]
    before, after = table[first], table[first + 1]
    bend = (2.0 - t) * bends[first] + (1.0 + t) * bends[first + 1]
    result = np.where(t == 1.0, after, before + t * (after - before) - t * (1.0 - t) * h**2 / 6.0 * bend)
    return result.reshape(len(places), *values.shape[1:])


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
