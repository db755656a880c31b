"""Tangents of a spline through points: twice continuous where the points allow, limited where they do not.

Slopes are derivatives by chord length, so that they are near 1 in size; every interval has one at its start
and one at its end, which differ from the neighbours' at corners only.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats, distinct
from meshonet.geometry.curves.limiter import limited
from meshonet.geometry.polygon.corners import Indices
from meshonet.kernels._native import solve_tridiagonal


def spline_slopes(points: Floats, *, closed: bool, corners: Indices) -> tuple[Floats, Floats]:
    """Return the slopes (intervals, 2) at the start and at the end of each interval.

    Between `corners`, indices of points (n, 2), the curve is the cubic spline whose tangent and curvature are
    continuous, with a parabola in the intervals next to a corner. `meshonet.geometry.curves.limiter` then
    removes overshoots. A closed curve does not repeat its first point.
    """
    if closed and corners.size == 0:
        slope = _periodic(points)
        start, stop = slope, np.roll(slope, -1, axis=0)
    elif closed:
        shift = int(corners[0])
        ring = np.roll(points, -shift, axis=0)
        start, stop = _pieces(np.concatenate([ring, ring[:1]]), np.append(corners - shift, len(points)))
        start, stop = np.roll(start, shift, axis=0), np.roll(stop, shift, axis=0)
    else:
        start, stop = _pieces(points, distinct(np.concatenate([[0], corners, [len(points) - 1]])))
    return limited(points, start, stop, closed=closed, corners=corners)


def _pieces(points: Floats, stops: Indices) -> tuple[Floats, Floats]:
    """Return slopes at both ends of each interval of an open curve, a spline of its own between two `stops`.

    One tridiagonal system for all: a stop has two unknowns, one for each side, whose rows do not touch
    each other. End condition: a parabola over the last interval, m_0 + m_1 = 2 delta_0.
    """
    chord = np.diff(points, axis=0)
    h = np.hypot(chord[:, 0], chord[:, 1])
    delta = chord / h[:, None]
    doubled = np.zeros(len(points), dtype=np.intp)
    doubled[stops[1:-1]] = 1
    first = np.arange(len(h)) + np.cumsum(doubled)[:-1]  # row of the slope at the start of each interval
    n = len(points) + len(stops) - 2
    lower, diagonal, upper, right = np.zeros(n), np.ones(n), np.zeros(n), np.empty((n, 2))
    begin, end = first[stops[:-1]], first[stops[1:] - 1] + 1
    alone = np.diff(stops) == 1  # a single interval between corners is a straight line
    upper[begin], lower[end] = np.where(alone, 0.0, 1.0), np.where(alone, 0.0, 1.0)
    right[begin] = np.where(alone, 1.0, 2.0)[:, None] * delta[stops[:-1]]
    right[end] = np.where(alone, 1.0, 2.0)[:, None] * delta[stops[1:] - 1]
    smooth = np.ones(len(points), dtype=bool)
    smooth[stops] = False
    k = np.flatnonzero(smooth)
    row = first[k]
    lower[row], diagonal[row], upper[row] = h[k], 2 * (h[k - 1] + h[k]), h[k - 1]
    right[row] = 3 * (h[k, None] * delta[k - 1] + h[k - 1, None] * delta[k])
    solve_tridiagonal(lower, diagonal, upper, right)
    return right[first], right[first + 1]


def _periodic(points: Floats) -> Floats:
    """Return slopes (n, 2) of the periodic spline, by Sherman and Morrison's formula."""
    chord = np.diff(points, axis=0, append=points[:1])
    h = np.hypot(chord[:, 0], chord[:, 1])
    delta = chord / h[:, None]
    before = np.roll(h, 1)
    lower, diagonal, upper = h.copy(), 2 * (before + h), before.copy()
    low, up, pivot = upper[-1], lower[0], -diagonal[0]
    diagonal[0] -= pivot
    diagonal[-1] -= low * up / pivot
    right = np.zeros((len(h), 3))
    right[:, :2] = 3 * (h[:, None] * np.roll(delta, 1, axis=0) + before[:, None] * delta)
    right[0, 2], right[-1, 2] = pivot, low
    solve_tridiagonal(lower, diagonal, upper, right)
    v = up / pivot
    factor = (right[0, :2] + v * right[-1, :2]) / (1 + right[0, 2] + v * right[-1, 2])
    return np.asarray(right[:, :2] - right[:, 2:] * factor)
