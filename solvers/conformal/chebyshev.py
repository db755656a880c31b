"""Chebyshev points of the unit interval, and interpolation from points as a matrix.

Berrut & Trefethen, Barycentric Lagrange Interpolation, SIAM Review 46 (2004) 501.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats


def points(n: int) -> Floats:
    """Return n Chebyshev points of the second kind in [0, 1], rising, the ends among them."""
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * np.arange(n) / (n - 1)))


def weights(n: int) -> Floats:
    """Return the barycentric weights of `points(n)`."""
    signs = (-1.0) ** np.arange(n)
    signs[[0, -1]] *= 0.5
    return np.asarray(signs, dtype=np.float64)


def barycentric(nodes: Floats, weights: Floats, x: Floats) -> Floats:
    """Return the (len(nodes), len(x)) matrix that takes values at `nodes` to values at `x`.

    Exact at the nodes themselves: a column there has one 1.

    >>> points(5) ** 4 @ barycentric(points(5), weights(5), np.array([0.0, 0.3]))
    array([0.    , 0.0081])
    """
    gap = x[None, :] - nodes[:, None]
    hit = gap == 0.0
    gap[hit] = 1.0
    matrix = weights[:, None] / gap
    matrix[:, hit.any(axis=0)] = 0.0
    matrix[hit] = 1.0
    matrix /= matrix.sum(axis=0)
    return np.asarray(matrix)
