"""Curves in space along which a section is swept: splines through points, or lines and arcs.

Curvature vectors point to the centre of curvature, with length 1/radius.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.spline import checked_points, cubics, open_slopes, periodic_slopes
from meshonet.geometry.elementary import cos, product, sin
from meshonet.geometry.errors import InputError


class PathPoints(NamedTuple):
    """Points, unit tangents and curvature vectors, (n, 3) each."""

    points: Floats
    tangents: Floats
    curvature: Floats


class Path(Protocol):
    """A curve in space, parametrised by its arc length."""

    length: float
    closed: bool

    def at(self, s: Floats) -> PathPoints:
        """Return points, tangents and curvature at arc lengths `s` (n,), between 0 and the path's length."""
        ...


# Gauss's quadrature with five points, from -1 to 1, of the speed in each part of an interval
_GAUSS = np.array([-0.906179845938664, -0.5384693101056831, 0.0, 0.5384693101056831, 0.906179845938664])
_WEIGHTS = np.array([0.236926885056189, 0.47862867049936636, 0.5688888888888889, *[0.0] * 2])
_WEIGHTS[3:] = _WEIGHTS[1::-1]
_PARTS = 16  # parts of an interval in the table of arc length


class SplinePath:
    """The cubic spline through `points` (n, 3), by cumulative chord length, with continuous curvature.

    A closed path repeats its first point; outer intervals of an open path are parabolas. Raises InputError:
    fewer than 2 points (closed: 4); equal neighbours; values that are not finite.

    >>> round(SplinePath(np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]])).length, 9)
    3.0
    """

    length: float
    closed: bool

    def __init__(self, points: Floats) -> None:
        self._points = nodes = checked_points(points, "path", "point {} of the path", 3)
        self.closed = bool(len(nodes) > 3 and np.array_equal(nodes[0], nodes[-1]))
        chord = np.diff(nodes, axis=0)
        h = norms(chord)
        if self.closed:
            start = periodic_slopes(chord, h)
            stop = np.roll(start, -1, axis=0)
        else:
            start, stop = open_slopes(chord, h, np.array([0, len(h)]))
        a, b = h[:, None] * start, h[:, None] * stop
        self._cubic = cubics(nodes[:-1], chord, a, b)
        edges = np.arange(_PARTS) / _PARTS
        t = (edges[:, None] + (0.5 + 0.5 * _GAUSS) / _PARTS).ravel()
        speed = norms(self._derivative(np.arange(len(h))[:, None], t[None, :]))
        pieces = product(speed.reshape(len(h), _PARTS, -1), 0.5 * _WEIGHTS / _PARTS)
        self._table = np.concatenate([[0.0], np.cumsum(pieces)])
        self.length = float(self._table[-1])

    def at(self, s: Floats) -> PathPoints:
        """Return points, tangents and curvature at arc lengths `s` (n,), between 0 and the path's length."""
        i, t = self._locate(np.clip(np.asarray(s, dtype=np.float64), 0.0, self.length))
        a, b, c, d = self._cubic[:, i]
        u = t[:, None]
        points = a + u * (b + u * (c + u * d))
        points = np.where(u == 1.0, self._points[i + 1], points)
        first, second = b + u * (2 * c + 3 * u * d), 2 * c + 6 * u * d
        speed = norms(first)[:, None]
        tangents = first / speed
        bend = second - (second * tangents).sum(axis=1, keepdims=True) * tangents
        return PathPoints(points, tangents, bend / speed**2)

    def _locate(self, s: Floats) -> tuple[np.ndarray[tuple[int], np.dtype[np.intp]], Floats]:
        """Return the interval and the parameter in it at arc lengths, by table and Newton's method."""
        count = len(self._table) - 1
        k = np.clip(np.searchsorted(self._table, s, side="right") - 1, 0, count - 1)
        i, low = k // _PARTS, (k % _PARTS) / _PARTS
        piece = self._table[k + 1] - self._table[k]
        t = low + (s - self._table[k]) / piece / _PARTS
        for _ in range(4):
            inner = low[:, None] + (t - low)[:, None] * (0.5 + 0.5 * _GAUSS)
            speed = norms(self._derivative(i[:, None], inner))
            arc = self._table[k] + (t - low) * product(speed, 0.5 * _WEIGHTS)
            here = norms(self._derivative(i, t))
            t = np.clip(t + (s - arc) / here, 0.0, 1.0)
        t = np.where(s >= self.length, 1.0, t)
        return i, np.asarray(np.where(s <= 0.0, 0.0, t))

    def _derivative(self, i: np.ndarray[tuple[int, ...], np.dtype[np.intp]], t: Floats) -> Floats:
        _, b, c, d = self._cubic[:, i]
        u = t[..., None]
        return np.asarray(b + u * (2 * c + 3 * u * d))


@dataclass(frozen=True)
class Bend:
    """A piece of a path: a straight segment or a circular arc.

    Parameters
    ----------
    length : length of the piece.
    radius : radius of the arc; 0 stands for a straight segment.
    towards : direction (3,) from the path to the centre of the arc.
    """

    length: float
    radius: float = 0.0
    towards: tuple[float, float, float] = (0.0, 0.0, 1.0)


class PiecedPath:
    """A path of `pieces` joined without kinks, from the point `start` (3,) in a `direction` (3,).

    The vector `towards` of an arc need not be perpendicular to the path; its part along the path is ignored.
    Raises InputError: no piece; a length of 0; a negative length or radius; a `towards` parallel to the path.
    """

    def __init__(self, pieces: tuple[Bend, ...], start: Floats, direction: Floats) -> None:
        if not pieces:
            raise InputError("a path without pieces", "give a line or an arc")
        self.closed = False
        starts, tangents, normals = [np.array(start, dtype=np.float64)], [], []
        tangent = _unit(np.array(direction, dtype=np.float64), "the direction of the path")
        for k, piece in enumerate(pieces):
            if not piece.length > 0 or piece.radius < 0:
                problem = f"a length of {piece.length:g} and a radius of {piece.radius:g}"
                raise InputError(problem, "use positive ones", place=f"pieces[{k}]")
            normal = np.zeros(3)
            if piece.radius:
                towards = np.array(piece.towards, dtype=np.float64)
                normal = _unit(towards - product(towards, tangent) * tangent, f"the bend of pieces[{k}]")
            tangents.append(tangent)
            normals.append(normal)
            end = _on_piece(starts[-1], tangent, normal, piece.radius, np.array([piece.length]))
            starts.append(end.points[0])
            tangent = end.tangents[0]
        self._radius = np.array([piece.radius for piece in pieces])
        self._ends = np.cumsum([0.0, *(piece.length for piece in pieces)])
        self.length = float(self._ends[-1])
        self._start, self._tangent, self._normal = np.array(starts), np.array(tangents), np.array(normals)

    def at(self, s: Floats) -> PathPoints:
        """Return points, tangents and curvature at arc lengths `s` (n,); at a joint, of the next piece."""
        s = np.clip(np.asarray(s, dtype=np.float64), 0.0, self.length)
        k = np.clip(np.searchsorted(self._ends, s, side="right") - 1, 0, len(self._radius) - 1)
        places = [np.empty((len(s), 3)) for _ in range(3)]
        for piece in range(len(self._radius)):
            own = k == piece
            made = _on_piece(
                self._start[piece], self._tangent[piece], self._normal[piece], self._radius[piece],
                s[own] - self._ends[piece],
            )  # fmt: skip
            for whole, part in zip(places, made, strict=True):
                whole[own] = part
        return PathPoints(*places)


def _on_piece(start: Floats, tangent: Floats, normal: Floats, radius: float, s: Floats) -> PathPoints:
    if radius == 0:
        straight = np.broadcast_to(tangent, (len(s), 3))
        return PathPoints(start + s[:, None] * tangent, straight, np.zeros((len(s), 3)))
    c, d = cos(s / radius)[:, None], sin(s / radius)[:, None]
    inwards = c * normal - d * tangent
    return PathPoints(
        start + radius * (d * tangent + (1 - c) * normal), c * tangent + d * normal, inwards / radius
    )


def _unit(vector: Floats, what: str) -> Floats:
    length = math.hypot(*vector)
    if not 1e-9 < length < 1e150:
        raise InputError(f"{what} has no direction", "give three numbers, not along the path, not all 0")
    return vector / length
