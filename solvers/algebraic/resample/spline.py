"""Cubic splines on uniform knots as matrices, so that a table of values is evaluated at any resolution.

On knots 0, 1, ..., m-1 with values f and second derivatives M the spline between knots k and k+1 is, with
t the place between them (0 to 1)::

    s = (1-t) f_k + t f_k+1 - t (1-t) (2-t)/6 M_k - t (1-t) (1+t)/6 M_k+1
    M_k-1 + 4 M_k + M_k+1 = 6 (f_k-1 - 2 f_k + f_k+1)

with the third derivative continuous at the second and the last but one knot ("not a knot"), or periodic.
de Boor, A Practical Guide to Splines (1978), chapter IV.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats


@lru_cache(maxsize=16)
def bending(m: int, periodic: bool) -> Floats:
    """Return the matrix (m, m) that takes values at m uniform knots to the second derivatives there.

    `m`: knots, at least 2; the last repeats the first when `periodic`. 2 give a straight line, 3 a parabola.
    `periodic`: the spline is.
    """
    if m == 2 or (periodic and m == 3):
        return np.zeros((m, m))
    difference = np.zeros((m, m))
    system = np.zeros((m, m))
    inner = np.arange(1, m - 1)
    for matrix, (before, at, after) in ((difference, (6.0, -12.0, 6.0)), (system, (1.0, 4.0, 1.0))):
        matrix[inner, inner - 1], matrix[inner, inner], matrix[inner, inner + 1] = before, at, after
    if periodic:
        difference[0, [m - 2, 0, 1]] = 6.0, -12.0, 6.0
        system[0, [m - 2, 0, 1]] = 1.0, 4.0, 1.0
        system[-1, [0, m - 1]] = 1.0, -1.0
    elif m == 3:
        system[0, :2] = system[-1, 1:] = 1.0, -1.0
    else:
        system[0, :3] = system[-1, -3:] = 1.0, -2.0, 1.0
    return np.asarray(np.linalg.solve(system, difference))


def between(values: Floats, n: int) -> Floats:
    """Return (..., n), linear between the columns of `values` (..., m), at equal steps; the ends are kept."""
    m = values.shape[-1]
    if n == m:
        return values
    first, t = _uniform(m, n)
    if t is None:
        return np.ascontiguousarray(values[..., first])
    before = values[..., first]
    result = before + t * (values[..., first + 1] - before)
    result[..., -1] = values[..., -1]
    return np.ascontiguousarray(result)


@lru_cache(maxsize=16)
def _uniform(m: int, n: int) -> tuple[NDArray[np.intp], Floats | None]:
    """Return for n uniform places among m the one before and the way to the next; None: all are places."""
    at = np.arange(n) * ((m - 1) / (n - 1))
    first = np.minimum(at.astype(np.intp), m - 2)
    t = np.asarray(at - first, dtype=np.float64)
    if t[:-1].any():
        return first, t
    return np.append(first[:-1], m - 1), None


@lru_cache(maxsize=16)
def places(m: int, n: int) -> tuple[NDArray[np.intp], Floats]:
    """Return for n uniform places over m knots the knot before each (n,) and four weights (n, 4).

    The weights go to the values at that knot and the next and to the second derivatives there.
    """
    at = np.arange(n) * ((m - 1) / (n - 1))
    first = np.minimum(at.astype(np.intp), m - 2)
    t = at - first
    t[-1] = 1.0
    bend = -t * (1.0 - t) / 6.0
    return first, np.stack([1.0 - t, t, bend * (2.0 - t), bend * (1.0 + t)], axis=1)


@lru_cache(maxsize=16)
def spline_matrix(m: int, n: int, periodic: bool = False) -> Floats:
    """Return the matrix (n, m) that takes values at m uniform knots to the spline at n uniform places.

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
