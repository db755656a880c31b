"""Chebyshev points, interpolation matrices, and panels of such points along eta.

Trefethen, Approximation Theory and Approximation Practice (2013), chapter 8; Berrut & Trefethen, Barycentric
Lagrange Interpolation, SIAM Review 46 (2004) 501.
"""

from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import cos, sin

NODES = 16  # as PANEL_NODES in kernels/conformal/strip_rows.h
NEAREST = 0.25  # psi from the wall's outermost point to the first panel
WORTH = 3  # times as many grid nodes as Chebyshev points: fewer are evaluated themselves


def points(n: int) -> Floats:
    """Return n Chebyshev points of the second kind in [0, 1], ascending, with both ends."""
    return np.asarray(0.5 - 0.5 * cos(np.pi * np.arange(n) / (n - 1)))


def weights(n: int) -> Floats:
    """Return the barycentric weights of `points(n)`."""
    signs = 1.0 - 2.0 * (np.arange(n) % 2)
    signs[[0, -1]] *= 0.5
    return np.asarray(signs, dtype=np.float64)


def barycentric(nodes: Floats, weights: Floats, x: Floats) -> Floats:
    """Return the matrix (len(nodes), len(x)) of polynomial interpolation from values at `nodes` to `x`.

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


class Panels(NamedTuple):
    """Consecutive intervals of eta (panels): panel k covers the grid levels ``ends[k]`` to ``ends[k + 1]``.

    `eta` (panels * NODES,) are interpolation points. A column of `matrix` (NODES, levels) has the weights
    with which the points of a panel give the value on a level. Without panels, `ends` has one entry.
    """

    ends: list[int]
    eta: Floats
    matrix: Floats


def panels(eta: Floats, height: float, spread: float, first: int, last: int) -> Panels:
    """Return panels: intervals of `eta` in which grid levels are interpolated from `NODES` Chebyshev points.

    `eta` (nj,) are the positions of the levels, from 0 at the wall to 1 at the far field. Panels lie between
    the levels `first` and `last` - 1; there are none if that would not save work. The domain is mapped onto a
    strip of mean width `height`, where the wall is a wavy line, `spread` high from trough to crest. Panels
    are at most as long there as their distance from the wall. The error is then 6e-13.
    """
    ends: list[int] = []
    points, matrices = [np.empty(0)], [np.empty((NODES, 0))]
    angle = np.pi * (np.arange(NODES) + 0.5) / NODES
    signed = sin(angle) * (1.0 - 2.0 * (np.arange(NODES) % 2))
    distance = NEAREST
    while spread + distance < height:
        far = spread + 2.0 * distance
        begin, end = np.searchsorted(eta, [(spread + distance) / height, far / height]).tolist()
        start = max(begin, first)
        stop = last if far >= height else min(end, last)
        if stop - start >= WORTH * NODES:
            a, b = eta[start], eta[stop - 1]
            points.append(0.5 * (a + b) - 0.5 * (b - a) * cos(angle))
            matrices.append(barycentric(points[-1], signed, eta[start:stop]))
            ends[-1:] = [start, stop]
        elif stop > start:  # too few levels here: they and all before them are evaluated themselves
            del ends[:], points[1:], matrices[1:]
        distance *= 2.0
    return Panels(ends or [len(eta) - 1], np.concatenate(points), np.concatenate(matrices, axis=1))
