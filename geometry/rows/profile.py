"""A profile of a blade: a closed curve around the blade, divided at its leading and trailing edge.

A place on it is u, in parts of the sides' lengths: 0 at the leading edge, over the side of larger theta to
0.5 at the trailing edge, and back to 1.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.elementary import arctan2
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.rows.channel import Channel
from meshonet.geometry.rows.profile_points import check_profile, distinct_points

_SAMPLES = 2000  # points of the curve among which the edges are looked for
_BASE = 0.1  # of the chord: corners that are no farther apart than this, and blunt, have an edge between them
_SEAM = 4  # points that are taken along beyond the first and the last


class BladeProfile:
    """A profile in a channel.

    Parameters
    ----------
    points : (n, 3) x, y, z around the profile in either direction, the axis along x; points may be repeated.
    channel : that it stands in.

    Raises InputError: too few points, points that are no closed curve around an area, or that are not in the
    channel's range.
    """

    def __init__(self, points: Floats, channel: Channel) -> None:
        p = distinct_points(points)
        r = np.hypot(p[:, 1], p[:, 2])
        theta = np.unwrap(arctan2(p[:, 1], p[:, 2]))
        s, h = channel.places(np.stack([p[:, 0], r], axis=1))
        outside = np.flatnonzero((s < 0.0) | (s > 1.0))
        if len(outside):
            k = int(outside[0])
            end = "begin behind" if s[k] < 0.0 else "end before"
            problem = f"hub and casing {end} the blade's point ({p[k, 0]:.6g}, {p[k, 1]:.6g}, {p[k, 2]:.6g})"
            raise InputError(problem, "give longer curves of hub and casing")
        self.height = float(h.mean())
        self.range = float(h.min()), float(h.max())
        self._map = channel.meridional(self.height)
        plane = np.stack([self._map.forward(s), theta], axis=1)
        check_profile(plane, p)
        if polygon_area(plane) > 0.0:
            plane, h = plane[::-1], h[::-1]
        self.curve = Curve(np.ascontiguousarray(plane), closed=True)
        self._h = h
        self.leading, self.trailing = self._edges()

    def _edges(self) -> tuple[float, float]:
        """Return the arc lengths of leading and trailing edge: the points farthest from each other."""
        arcs = np.linspace(0.0, self.curve.length, _SAMPLES, endpoint=False)
        points = self.curve.at(arcs)
        ends = [points[int(norms(points - points.mean(axis=0)).argmax())]]
        found = [0.0]
        for _ in range(6):
            found.append(self._farthest(ends[-1], arcs, points))
            ends.append(self.curve.at(np.array([found[-1]]))[0])
        one, two = (self._blunt(arc) for arc in found[-2:])
        x = self.curve.at(np.array([one, two]))[:, 0]
        return (one, two) if x[0] < x[1] else (two, one)

    def _farthest(self, point: Floats, arcs: Floats, points: Floats) -> float:
        """Return the arc length that is farthest from a point, between samples by a parabola."""
        away = norms(points - point)
        k = int(away.argmax())
        before, here, after = away[k - 1], away[k], away[(k + 1) % len(away)]
        bend = before - 2.0 * here + after
        shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
        near = np.abs(self.curve.corners - arcs[k])
        if len(near) and near.min() < 1.5 * arcs[1]:  # a corner is the farthest point itself
            return float(self.curve.corners[int(near.argmin())])
        return float(arcs[k] + shift * arcs[1])

    def _blunt(self, arc: float) -> float:
        """Return the middle of a base if the curve is cut off there by two corners, otherwise `arc`."""
        corners, length = self.curve.corners, self.curve.length
        off = np.mod(corners - arc + 0.5 * length, length) - 0.5 * length
        near = np.sort(off[np.abs(off) < _BASE * 0.5 * length])
        if len(near) != 2:
            return arc
        return float(np.mod(arc + 0.5 * (near[0] + near[1]), length))

    @cached_property
    def _sides(self) -> tuple[float, float]:
        """Lengths of the sides, from the leading to the trailing edge and back."""
        first = float(np.mod(self.trailing - self.leading, self.curve.length))
        return first, self.curve.length - first

    @cached_property
    def thickness(self) -> float:
        """Largest angle in radians between the sides at one m', about."""
        u = np.linspace(0.0, 0.5, _SAMPLES // 2)
        sides = [self.curve.at(self.arcs(places)).T for places in (u, 1.0 - u)]
        at = np.linspace(sides[0][0][0], sides[0][0][-1], _SAMPLES // 2)
        first, second = (np.interp(at, np.maximum.accumulate(m), theta) for m, theta in sides)
        return float(np.abs(first - second).max())

    def arcs(self, u: Floats) -> Floats:
        """Return arc lengths (n,) of places u (n,), 0 to 1."""
        first, second = self._sides
        way = np.where(u <= 0.5, 2.0 * u * first, first + (2.0 * u - 1.0) * second)
        return np.asarray(np.mod(self.leading + way, self.curve.length))

    def corner_places(self) -> Floats:
        """Return u (c,) of the corners, ascending."""
        first, second = self._sides
        way = np.mod(self.curve.corners - self.leading, self.curve.length)
        return np.sort(np.where(way <= first, 0.5 * way / first, 0.5 + 0.5 * (way - first) / second))

    def at(self, u: Floats) -> Floats:
        """Return s, theta, h (n, 3) at places u (n,)."""
        arcs = self.arcs(u)
        m, theta = self.curve.at(arcs).T
        return np.stack([self._map.back(m), theta, self._heights(arcs)], axis=1)

    @cached_property
    def _heights(self) -> CubicTable:
        """Heights by arc length, over the seam."""
        around = np.arange(-_SEAM, len(self._h) + _SEAM)
        turns, number = np.divmod(around, len(self._h))
        return CubicTable(self._h[number], self.curve.knots[number] + turns * self.curve.length)
