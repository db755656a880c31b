"""Curves through given points, measured by arc length.

Between two corners a curve is a cubic spline: one cubic an interval, continuous tangent and curvature,
through every given point. Where a spline would invent a bump, its tangents are limited (`_limited`), which
keeps the tangent continuous and gives up the curvature there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geometry._spline import solve_tridiagonal
from geometry.arrays import Floats
from geometry.errors import InputError

Indices = NDArray[np.intp]

_STEPS = 8
"""Sub-intervals of one spline interval in the table of arc length: its error is then below 1e-6 of the interval."""
_GAUSS = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)]), np.array([5.0, 8.0, 5.0]) / 18.0


class Curve:
    """A curve through given points.

    Parameters
    ----------
    points : (n, 2) at least 2 points (3 when closed), any unit of length, neighbours distinct. A closed
        curve may repeat its first point at the end.
    closed : the curve returns from the last point to the first.
    corners : indices of points where the tangent jumps; None finds them by turning angle
        (`find_corners`). The ends of an open curve are corners anyway.

    Raises
    ------
    InputError
        too few points, a point that is not finite or equals its neighbour, a corner out of range.

    Examples
    --------
    >>> square = Curve(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), closed=True)
    >>> square.length
    4.0
    >>> square.at(np.array([2.5]))
    array([[0.5, 1. ]])
    """

    def __init__(
        self, points: Floats, *, closed: bool = False, corners: Sequence[int] | Indices | None = None
    ) -> None:
        given = _checked(points, closed)
        self.points, self.closed = given, closed
        index = (
            find_corners(given, closed=closed)
            if corners is None
            else np.unique(np.asarray(corners, dtype=np.intp))
        )
        if index.size and (index[0] < 0 or index[-1] >= len(given)):
            raise InputError(
                f"corner {index[-1]} of {len(given)} points does not exist", "count points from 0"
            )
        self.corner_index: Indices = index
        self._build(*_tangents(given, closed, index))

    def _build(self, start: Floats, stop: Floats) -> None:
        """Make the cubics from the tangents (intervals, 2) at both ends of each interval, and the table of arc length."""
        ends = np.concatenate([self.points, self.points[:1]]) if self.closed else self.points
        chord = np.diff(ends, axis=0)
        h = np.hypot(chord[:, 0], chord[:, 1])[:, None]
        first, last = h * start, h * stop
        one = np.stack([ends[:-1], first, 3 * chord - 2 * first - last, first + last - 2 * chord])
        # one more interval of length zero, so that the last point is met bitwise
        end = np.stack([ends[-1:], last[-1:], np.zeros((1, 2)), np.zeros((1, 2))])
        self._cubic: Floats = np.concatenate([one, end], axis=1)
        nodes, weights = _GAUSS
        t = (np.arange(_STEPS)[:, None] + nodes) / _STEPS
        speed = _norm(self._derivative(np.arange(len(h))[:, None], t.ravel()[None, :]))
        pieces = speed.reshape(-1, 3) @ weights / _STEPS
        self._table: Floats = np.concatenate([[0.0], np.cumsum(pieces)])
        speeds = _norm(
            self._derivative(np.arange(len(h))[:, None], (np.arange(_STEPS) / _STEPS)[None, :])
        ).ravel()
        stops = _norm(
            self._derivative(np.arange(len(h))[:, None], ((np.arange(_STEPS) + 1.0) / _STEPS)[None, :])
        ).ravel()
        self._slopes = np.stack([_rate(pieces, speeds), _rate(pieces, stops)])
        self.length = float(self._table[-1])
        self.knots: Floats = self._table[::_STEPS][: len(self.points)].copy()
        self.corners: Floats = self.knots[self.corner_index]

    def _derivative(self, i: NDArray[np.intp], t: Floats) -> Floats:
        _, b, c, d = (part[i] for part in self._cubic)
        t = t[..., None]
        return b + t * (2 * c + 3 * t * d)

    def _locate(self, s: Floats) -> tuple[NDArray[np.intp], Floats]:
        """Return interval and parameter within it (0 to 1) at arc lengths s (m,)."""
        s = np.asarray(s, dtype=np.float64)
        s = (
            np.where(s == self.length, s, np.mod(s, self.length))
            if self.closed
            else np.clip(s, 0.0, self.length)
        )
        k = np.searchsorted(self._table, s, side="right") - 1
        last = len(self._table) - 1
        inside = np.minimum(k, last - 1)
        width = self._table[inside + 1] - self._table[inside]
        f = (s - self._table[inside]) / width
        a, b = self._slopes[0][inside], self._slopes[1][inside]
        t = f * (a + f * ((3 - 2 * a - b) + f * (a + b - 2)))
        t = np.where(k == last, 0.0, (inside % _STEPS + t) / _STEPS)
        return k // _STEPS, t

    def at(self, s: Floats) -> Floats:
        """Return the points (m, 2) at arc lengths `s` (m,); a closed curve takes any s, an open one clips it."""
        i, t = self._locate(s)
        a, b, c, d = (part[i] for part in self._cubic)
        t = t[..., None]
        return np.asarray(a + t * (b + t * (c + t * d)))

    def tangent(self, s: Floats) -> Floats:
        """Return unit tangents (m, 2) at arc lengths `s` (m,); at a corner, that of the side that leaves it."""
        d = self._derivative(*self._locate(s))
        return np.asarray(d / _norm(d)[..., None])

    def curvature(self, s: Floats) -> Floats:
        """Return signed curvature (m,), 1/length, at arc lengths `s`; positive where the curve turns left."""
        i, t = self._locate(s)
        d = self._derivative(i, t)
        _, _, c, e = (part[i] for part in self._cubic)
        bend = 2 * c + 6 * t[..., None] * e
        return np.asarray((d[..., 0] * bend[..., 1] - d[..., 1] * bend[..., 0]) / _norm(d) ** 3)


def find_corners(points: Floats, *, closed: bool = False, turn: float = 30.0) -> Indices:
    """Return indices of the points where the polygon turns by more than `turn` degrees at once.

    A corner turns sharply and its neighbours do not: a point counts when it turns by more than `turn`
    and by more than three times as much as each of its neighbours, in the same sense or not. So the
    round but coarsely given end of a body stays smooth, unless the points beside it lie on straight lines.

    Parameters
    ----------
    points : (n, 2) neighbours distinct.
    closed : the last point is joined to the first.
    turn : degrees.

    Examples
    --------
    >>> find_corners(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])).tolist()
    [1]
    """
    angle = np.abs(turning(points, closed=closed))
    if closed:
        beside = np.maximum(np.roll(angle, 1), np.roll(angle, -1))
    else:
        beside = np.maximum(np.append(0.0, angle[:-1]), np.append(angle[1:], 0.0))
    sharp = (angle > np.radians(turn)) & (
        (angle > 3 * beside) | (angle > np.radians(75.0)) & (angle < np.radians(105.0))
    )
    if closed and len(points) <= 6:
        sharp = angle > np.radians(turn)
    return np.flatnonzero(sharp)


def turning(points: Floats, *, closed: bool = False) -> Floats:
    """Return the angle (n,) in radians by which a polygon (n, 2) turns at each point, left positive, 0 at open ends."""
    ring = np.concatenate([points[-1:], points, points[:1]]) if closed else points
    d = np.diff(ring, axis=0)
    cross = d[:-1, 0] * d[1:, 1] - d[:-1, 1] * d[1:, 0]
    dot = d[:-1, 0] * d[1:, 0] + d[:-1, 1] * d[1:, 1]
    angle = np.arctan2(cross, dot)
    return np.asarray(angle if closed else np.concatenate([[0.0], angle, [0.0]]))


def resample_like(nodes: Floats, m: int, *, closed: bool) -> Floats:
    """Return `m` nodes on the curve through `nodes` (n, 2), spaced by the same law.

    The arc length as a function of the node's place along the edge (0 to 1) is kept; corners stay nodes;
    the end nodes are kept bitwise.

    Parameters
    ----------
    nodes : (n, 2); closed edges repeat their first node at the end.
    m : number of nodes wanted, at least 2.
    closed : the edge returns to its start.
    """
    from geometry.sampling import monotone_cubic

    curve = Curve(nodes[:-1] if closed else nodes, closed=closed)
    n = len(nodes)
    knots = np.append(curve.knots, curve.length) if closed else curve.knots
    stops = np.unique(np.concatenate([[0], curve.corner_index, [n - 1]]))
    place = np.rint(stops * ((m - 1) / (n - 1))).astype(int)
    s = np.empty(m)
    for a, b, p, q in zip(stops[:-1], stops[1:], place[:-1], place[1:], strict=True):
        if q > p:
            s[p : q + 1] = monotone_cubic(
                np.linspace(0, 1, b - a + 1), knots[a : b + 1], np.linspace(0, 1, q - p + 1)
            )
    out = curve.at(s)
    out[0], out[-1] = nodes[0], nodes[-1]
    return out


def _checked(points: Floats, closed: bool) -> Floats:
    given = np.array(points, dtype=np.float64)
    if given.ndim != 2 or given.shape[1] != 2:
        raise InputError(f"curve points have shape {given.shape}", "give (n, 2)")
    if closed and len(given) > 1 and np.array_equal(given[0], given[-1]):
        given = given[:-1]
    least = 3 if closed else 2
    if len(given) < least:
        raise InputError(f"a curve of {len(given)} points is not possible", f"give at least {least}")
    bad = np.flatnonzero(~np.isfinite(given).all(axis=1))
    if bad.size:
        raise InputError(f"curve point {bad[0]} is not finite", "check the input for NaN or infinity")
    step = np.diff(given, axis=0, append=given[:1]) if closed else np.diff(given, axis=0)
    same = np.flatnonzero((step == 0).all(axis=1))
    if same.size:
        x, y = given[same[0]]
        raise InputError(f"curve point {same[0]} and the next are the same ({x:.6g}, {y:.6g})", "remove one")
    return given


def _tangents(points: Floats, closed: bool, corners: Indices) -> tuple[Floats, Floats]:
    """Return the derivatives by chord length (intervals, 2) at both ends of each interval."""
    n = len(points)
    if closed and corners.size == 0:
        slope = _periodic_slopes(points)
        return slope, np.roll(slope, -1, axis=0)
    if closed:
        shift = int(corners[0])
        ring = np.roll(points, -shift, axis=0)
        start, stop = _open_slopes(np.concatenate([ring, ring[:1]]), np.append(corners - shift, n))
        return np.roll(start, shift, axis=0), np.roll(stop, shift, axis=0)
    return _open_slopes(points, np.unique(np.concatenate([[0], corners, [n - 1]])))


def _open_slopes(points: Floats, stops: Indices) -> tuple[Floats, Floats]:
    """Return slopes at both ends of each interval; a spline of its own between any two `stops`.

    One tridiagonal system for all: a stop has two unknowns, one for each side, in rows that do not
    touch each other. Its end condition is a parabola over the first interval, m_0 + m_1 = 2 delta_0.
    """
    chord = np.diff(points, axis=0)
    h = np.hypot(chord[:, 0], chord[:, 1])
    delta = chord / h[:, None]
    # knots with every inner stop doubled: unknown row of the start of interval i is first[i]
    inner = np.zeros(len(points), dtype=np.intp)
    inner[stops[1:-1]] = 1
    first = np.arange(len(h)) + np.cumsum(inner)[:-1]
    n = len(points) + len(stops) - 2
    lower, diagonal, upper, right = np.zeros(n), np.ones(n), np.zeros(n), np.empty((n, 2))
    begin, end = first[stops[:-1]], first[stops[1:] - 1] + 1
    upper[begin], right[begin] = 1.0, 2 * delta[stops[:-1]]
    lower[end], right[end] = 1.0, 2 * delta[stops[1:] - 1]
    alone = np.flatnonzero(np.diff(stops) == 1)  # a single interval is a straight line
    for rows, at in ((begin[alone], stops[:-1][alone]), (end[alone], stops[:-1][alone])):
        upper[rows], lower[rows], right[rows] = 0.0, 0.0, delta[at]
    smooth = np.setdiff1d(np.arange(1, len(points) - 1), stops)
    row = first[smooth]
    lower[row], diagonal[row], upper[row] = h[smooth], 2 * (h[smooth - 1] + h[smooth]), h[smooth - 1]
    right[row] = 3 * (h[smooth, None] * delta[smooth - 1] + h[smooth - 1, None] * delta[smooth])
    solve_tridiagonal(lower, diagonal, upper, right)
    return right[first], right[first + 1]


def _periodic_slopes(points: Floats) -> Floats:
    """Return slopes (n, 2) of the periodic spline: the bordered system by Sherman and Morrison's formula."""
    chord = np.diff(points, axis=0, append=points[:1])
    h = np.hypot(chord[:, 0], chord[:, 1])
    delta = chord / h[:, None]
    before, delta_before = np.roll(h, 1), np.roll(delta, 1, axis=0)
    lower, diagonal, upper = h.copy(), 2 * (before + h), before.copy()
    corner_low, corner_up = upper[-1], lower[0]
    pivot = -diagonal[0]
    diagonal[0] -= pivot
    diagonal[-1] -= corner_low * corner_up / pivot
    right = np.zeros((len(h), 3))
    right[:, :2] = 3 * (h[:, None] * delta_before + before[:, None] * delta)
    right[0, 2], right[-1, 2] = pivot, corner_low
    solve_tridiagonal(lower, diagonal, upper, right)
    v = corner_up / pivot
    factor = (right[0, :2] + v * right[-1, :2]) / (1 + right[0, 2] + v * right[-1, 2])
    return np.ascontiguousarray(right[:, :2] - right[:, 2:] * factor)


def _norm(d: Floats) -> Floats:
    return np.asarray(np.hypot(d[..., 0], d[..., 1]))


def _rate(pieces: Floats, speed: Floats) -> Floats:
    """Return dt/ds of each piece scaled to unit t and unit s, limited so that the inverse stays monotone."""
    return np.minimum(pieces * _STEPS / np.maximum(speed, 1e-300), 3.0)
