"""Chebyshev points of the unit interval and interpolation between them, as a matrix.

Berrut & Trefethen, Barycentric Lagrange Interpolation, SIAM Review 46 (2004) 501.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats


def points(n: int) -> Floats:
    """Return n Chebyshev points of the second kind in [0, 1], rising, the ends among them."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(n) / (n - 1)))


def interpolation(n: int, where: Floats) -> Floats:
    """Return the (len(where), n) matrix from values at `points(n)` to values at `where`.

    Exact at the points themselves: a row there has one 1.

    Examples
    --------
    >>> interpolation(5, np.array([0.0, 0.3])) @ points(5) ** 4
    array([0.    , 0.0081])
    """
    weights = (-1.0) ** np.arange(n)
    weights[[0, -1]] *= 0.5
    gap = where[:, None] - points(n)[None, :]
    hit = gap == 0.0
    gap[hit] = 1.0
    matrix = weights / gap
    matrix[hit.any(axis=1)] = 0.0
    matrix[hit] = 1.0
    return np.asarray(matrix / matrix.sum(axis=1, keepdims=True))
