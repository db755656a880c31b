"""A profile of a blade: a closed curve, divided at its leading and trailing edge."""

from collections.abc import Sequence
from copy import copy
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, norms, shortest_ways, wrapped
from meshonet.geometry.cached import cached_property
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.elementary import arctan2
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.rows.channel import Channel
from meshonet.geometry.rows.profile_points import check_profile, distinct_points

_SAMPLES = 2000  # points of the curve among which the edges are looked for
_BASE = 0.1  # of the chord: corners that are no farther apart than this, and blunt, have an edge between them
_ENDS = np.array([0.0, 0.5, 1.0])  # places of the edges
_LONGER = "use longer curves of hub and casing, inlet and outlet away from the blade, and one unit for all"
_SEAM = 4  # points that are taken along beyond the first and the last
_ONE_POINT = np.radians(90.0)  # an edge that turns more at one point may be meant as pointed
_OTHER_UNIT = 1.5  # factor between radii of blade and channel from which on their units must differ


class BladeProfile:
    """A profile of a blade in a channel: a closed curve around the blade.

    A place u on it is 0 at the leading edge. It grows along the side of larger theta to 0.5 at the trailing
    edge, and along the other side to 1.

    Parameters
    ----------
    points : (n, 3) x, y, z around the profile, in either direction; x is the axis of the machine.
    channel : the channel in which the profile stands.

    Raises InputError: too few points; points that enclose no area, or are outside the channel.
    """

    def __init__(self, points: Floats, channel: Channel) -> None:
        p = distinct_points(points)
        r = np.hypot(p[:, 1], p[:, 2])
        theta = np.unwrap(arctan2(p[:, 1], p[:, 2]))
        _check_unit(r, channel)
        s, h = channel.places(np.stack([p[:, 0], r], axis=1))
        outside = np.flatnonzero((s < 0.0) | (s > 1.0))
        if len(outside):
            k = int(outside[0])
            end = "begin behind" if s[k] < 0.0 else "end before"
            problem = f"hub and casing {end} the blade's point ({p[k, 0]:.6g}, {p[k, 1]:.6g}, {p[k, 2]:.6g})"
            raise InputError(problem, _LONGER)
        self.height = float(h.mean())
        self.range = float(h.min()), float(h.max())
        self._map = channel.meridional(self.height)
        plane = np.stack([self._map.forward(s), theta], axis=1)
        check_profile(plane, p)
        if polygon_area(plane) > 0.0:
            plane, h = plane[::-1], h[::-1]
        self.heights = h
        self._follow(Curve(np.ascontiguousarray(plane), closed=True))

    def _follow(self, curve: Curve, tips: tuple[int | None, int | None] = (None, None)) -> None:
        """Take a curve for the profile; `tips` are the points known to be its edges."""
        self.curve = curve
        leading, trailing = self._edges()
        self.leading = leading if tips[0] is None else float(curve.knots[tips[0]])
        self.trailing = trailing if tips[1] is None else float(curve.knots[tips[1]])
        self._stops = _ENDS, np.array([0.0, self._sides[0], curve.length])

    def cornered(self, counts: Sequence[int]) -> Self:
        """Return the profile with `counts` (0, 1 or 2) corners at the leading and at the trailing edge.

        Corners are the points with the largest turns near an edge. An edge with one corner is moved to it.
        """
        edges, curve = (self.leading, self.trailing), self.curve
        bend = np.abs(turning(curve.points, closed=True))
        apart = [np.abs(self._off(curve.corners, edge)) >= self._reach for edge in edges]
        corners = curve.corner_index[apart[0] & apart[1]].tolist()
        tips: list[int | None] = []
        for edge, count in zip(edges, counts, strict=True):
            near = np.flatnonzero(np.abs(self._off(curve.knots, edge)) < self._reach)
            most = near[np.argsort(-bend[near], kind="stable")[:count]].tolist()
            corners += most
            tips.append(most[0] if count == 1 else None)
        made = copy(self)
        made._follow(Curve(curve.points, closed=True, corners=sorted(corners)), (tips[0], tips[1]))
        return made

    def aligned(self, places: Floats) -> Self:
        """Return the profile with another coordinate u around it; u is `places` (c,) at corners."""
        made, own = copy(self), self.corner_places()
        u = np.concatenate([_ENDS, places])
        way = np.concatenate([self._stops[1], np.interp(own, *self._stops)])
        _, kept = np.unique(u, return_index=True)
        made._stops = u[kept], way[kept]
        return made

    @property
    def _reach(self) -> float:
        """Arc length beside an edge within which corners belong to it."""
        return _BASE * 0.5 * self.curve.length

    def _off(self, arcs: Floats, edge: float) -> Floats:
        """Return signed distances (n,) along the curve from an edge, at arc lengths (n,)."""
        length = self.curve.length
        return shortest_ways(arcs - edge, length)

    def reshaped(self, plane: Floats, heights: Floats) -> Self:
        """Return the profile through other points: their m' and theta are `plane` (n, 2).

        m' is defined in `MeridionalMap`. Their `heights` (n,) are from 0 at the hub to 1 at the casing.
        """
        made = copy(self)
        made.__dict__ = {k: v for k, v in vars(self).items() if k not in ("thickness", "_heights")}
        made.heights = heights
        made._follow(Curve(np.ascontiguousarray(plane), closed=True))
        return made

    @property
    def corner_counts(self) -> tuple[int, int]:
        """Number of corners at the leading and at the trailing edge."""
        one, two = (
            int((np.abs(self._off(self.curve.corners, edge)) < self._reach).sum())
            for edge in (self.leading, self.trailing)
        )
        return one, two

    def edge(self, trailing: bool) -> str:
        """Return the form of the leading or `trailing` edge as text, with a hint if points may be missing."""
        count = self.corner_counts[trailing]
        if count:
            return {1: "pointed", 2: "blunt"}.get(count, "polygonal")
        turn = self.sharpness(trailing)[0]
        return (
            f"round, by one point that turns by {np.degrees(turn):.0f} degrees"
            if turn > _ONE_POINT
            else "round"
        )

    def sharpness(self, trailing: bool) -> tuple[float, float]:
        """Return the largest turn at a point of the leading or `trailing` edge, in radians, and a fraction.

        The fraction is the sum of the two largest turns divided by the sum of all turns at the edge.
        """
        bend = np.abs(turning(self.curve.points, closed=True))
        edge = self.trailing if trailing else self.leading
        own = np.sort(bend[np.abs(self._off(self.curve.knots, edge)) < self._reach])
        return float(own[-1]), float(own[-2:].sum() / own.sum())

    def _edges(self) -> tuple[float, float]:
        """Return the arc lengths of leading and trailing edge, the points farthest apart."""
        arcs = np.linspace(0.0, self.curve.length, _SAMPLES, endpoint=False)
        points = self.curve.at(arcs)
        ends = [points[int(norms(points - points.mean(axis=0)).argmax())]]
        tips = [0.0]
        for _ in range(6):
            tips.append(self._farthest(ends[-1], arcs, points))
            ends.append(self.curve.at(np.array([tips[-1]]))[0])
        one, two = (self._blunt(arc) for arc in tips[-2:])
        x = self.curve.at(np.array([one, two]))[:, 0]
        return (one, two) if x[0] < x[1] else (two, one)

    def _farthest(self, point: Floats, arcs: Floats, points: Floats) -> float:
        """Return the arc length farthest from a point."""
        away = norms(points - point)
        k = int(away.argmax())
        before, here, after = away[k - 1], away[k], away[(k + 1) % len(away)]
        bend = before - 2.0 * here + after
        shift = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
        near = np.abs(self._off(self.curve.corners, float(arcs[k])))
        if len(near) and near.min() < 1.5 * arcs[1]:  # a corner is the farthest point itself
            return float(self.curve.corners[int(near.argmin())])
        return float(arcs[k] + shift * arcs[1])

    def _blunt(self, arc: float) -> float:
        """Return the middle of a base between two corners near `arc`, else `arc`."""
        off = self._off(self.curve.corners, arc)
        near = np.sort(off[np.abs(off) < self._reach])
        if len(near) != 2:
            return arc
        return float(np.mod(arc + 0.5 * (near[0] + near[1]), self.curve.length))

    @property
    def _sides(self) -> tuple[float, float]:
        """Lengths of the sides, from the leading to the trailing edge and back."""
        first = float(np.mod(self.trailing - self.leading, self.curve.length))
        return first, self.curve.length - first

    @cached_property
    def thickness(self) -> float:
        """Approximate largest difference of theta, in radians, between the two sides."""
        u = np.linspace(0.0, 0.5, _SAMPLES // 2)
        sides = [self.curve.at(self.arcs(places)).T for places in (u, 1.0 - u)]
        at = np.linspace(sides[0][0][0], sides[0][0][-1], _SAMPLES // 2)
        first, second = (np.interp(at, np.maximum.accumulate(m), theta) for m, theta in sides)
        return float(np.abs(first - second).max())

    def arcs(self, u: Floats) -> Floats:
        """Return the arc lengths (n,) along the profile at places `u` (n,); u is from 0 to 1 around it."""
        return np.asarray(np.mod(self.leading + np.interp(u, *self._stops), self.curve.length))

    def corner_places(self) -> Floats:
        """Return the coordinate u (c,) of corners, -0.25 to 0.75: 0 leading edge, 0.5 trailing edge."""
        u, way = self._stops
        at = np.interp(np.mod(self.curve.corners - self.leading, self.curve.length), way, u)
        return np.sort(wrapped(at, -0.25))

    def at(self, u: Floats) -> Floats:
        """Return coordinates s, theta, h (n, 3) at places `u` (n,) around the profile.

        u: 0 leading, 0.5 trailing edge. s: 0 inlet, 1 outlet. h: 0 hub, 1 casing. theta: about the axis.
        """
        arcs = self.arcs(u)
        m, theta = self.curve.at(arcs).T
        return np.stack([self._map.back(m), theta, self._heights(arcs)], axis=1)

    @cached_property
    def _heights(self) -> CubicTable:
        around = np.arange(-_SEAM, len(self.heights) + _SEAM)
        turns, number = np.divmod(around, len(self.heights))
        return CubicTable(self.heights[number], self.curve.knots[number] + turns * self.curve.length)


def _check_unit(r: Floats, channel: Channel) -> None:
    """Raise InputError if a profile is so far outside the channel that units must differ."""
    low, high = float(r.min()), float(r.max())
    inner, outer = channel.radii
    if low > _OTHER_UNIT * outer or _OTHER_UNIT * high < inner:
        problem = f"lies at r = {low:.6g} to {high:.6g}, hub and casing at {inner:.6g} to {outer:.6g}"
        raise InputError(problem, "give all lengths in one unit, about one axis")
