"""Cubic splines on uniform knots as matrices: de Boor, A Practical Guide to Splines (1978), chapter IV."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import power, product


@lru_cache(maxsize=16)
def bending(m: int, periodic: bool) -> Floats:
    """Return the matrix (m, m) from values f at m >= 2 uniform knots to second derivatives M of the spline.

    The third derivative is continuous at the second and the last but one knot ("not a knot"), and ::

        M_k-1 + 4 M_k + M_k+1 = 6 (f_k-1 - 2 f_k + f_k+1)

    If `periodic`, the last knot repeats the first. 2 knots give a straight line, 3 knots a parabola.
    """
    if m == 2 or (periodic and m == 3):
        return np.zeros((m, m))
    bends = np.zeros((m, m))  # at first the right-hand sides
    inner = np.arange(1, m - 1)
    bends[inner, inner - 1], bends[inner, inner], bends[inner, inner + 1] = 6.0, -12.0, 6.0
    if periodic:
        bends[0, [m - 2, 0, 1]] = 6.0, -12.0, 6.0
        bends[:-1] = product(_around(m - 1), bends[:-1])
        bends[-1] = bends[0]
        return bends
    bends[[1, -2]] = bends[[1, -2]] / 6.0  # not a knot: M_0 + M_2 = 2 M_1
    _solve_between(bends[1:-1])
    bends[0], bends[-1] = (bends[1], bends[1]) if m == 3 else (2.0 * bends[[1, -2]] - bends[[2, -3]])
    return bends


def _around(n: int) -> Floats:
    """Return the inverse (n, n) of the circulant tridiagonal matrix of rows 1, 4, 1."""
    z, k = math.sqrt(3.0) - 2.0, np.arange(n)
    row = (power(z, k) + power(z, n - k)) / (2.0 * math.sqrt(3.0) * (1.0 - z**n))
    return np.asarray(row[(k[:, None] - k) % n])


def _solve_between(rows: Floats) -> None:
    """Solve x_k-1 + 4 x_k + x_k+1 = `rows` in place by Thomas' algorithm; the first and last rows hold x."""
    last, part = len(rows) - 1, 0.0
    parts = []
    for k in range(1, last):
        part = 1.0 / (4.0 - part)
        parts.append(part)
        rows[k] = part * (rows[k] - rows[k - 1])
    for k in range(last - 1, 0, -1):
        rows[k] -= parts[k - 1] * rows[k + 1]


def between(values: Floats, n: int) -> Floats:
    """Return values (..., n) at n uniform places, interpolated linearly from `values` (..., m) at m knots."""
    m = values.shape[-1]
    if n == m:
        return values
    first, weights = places(m, n)
    t = weights[:, 1]
    if not t[:-1].any():  # every place is a knot
        return np.ascontiguousarray(values[..., np.append(first[:-1], m - 1)])
    before = values[..., first]
    result = before + t * (values[..., first + 1] - before)
    result[..., -1] = values[..., -1]
    return np.ascontiguousarray(result)


@lru_cache(maxsize=16)
def places(m: int, n: int) -> tuple[NDArray[np.intp], Floats]:
    """Return, for each of n uniform places, the index (n,) of the knot k before it, and weights (n, 4).

    The weights multiply f_k, f_k+1, M_k and M_k+1: values f at m uniform knots, and second derivatives M with
    respect to the knot's index. At the fraction t between the knots k and k+1, the spline is ::

        s = (1-t) f_k + t f_k+1 - t (1-t) (2-t)/6 M_k - t (1-t) (1+t)/6 M_k+1
    """
    at = np.arange(n) * ((m - 1) / (n - 1))
    first = np.minimum(at.astype(np.intp), m - 2)
    t = at - first
    t[-1] = 1.0
    bend = -t * (1.0 - t) / 6.0
    return first, np.stack([1.0 - t, t, bend * (2.0 - t), bend * (1.0 + t)], axis=1)


@lru_cache(maxsize=16)
def spline_matrix(m: int, n: int, periodic: bool = False) -> Floats:
    """Return the matrix (n, m) from values at m uniform knots to values of the spline at n uniform places.

    >>> cubes = np.arange(5.0) ** 3
    >>> np.abs(spline_matrix(5, 9) @ cubes - np.linspace(0, 4, 9) ** 3).max() < 1e-12
    np.True_
    """
    bends = bending(m, periodic)
    first, weights = places(m, n)
    matrix, rows = np.zeros((n, m)), np.arange(n)
    matrix[rows, first] += weights[:, 0]
    matrix[rows, first + 1] += weights[:, 1]
    matrix += weights[:, 2:3] * bends[first] + weights[:, 3:] * bends[first + 1]
    return matrix
