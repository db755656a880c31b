"""The annular channel of a blade row, and the surfaces of revolution between hub and casing.

Straight lines join points of equal s on both. Along them h is 0 at the hub, `foot` and `tip` at gaps of
constant width, 1 at the casing.
"""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, cross2, middle, norms
from meshonet.geometry.cached import cached_property
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError, in_place
from meshonet.geometry.rows.profile_points import apart
from meshonet.kernels._native import (
    channel_nodes,
    channel_points,
    channel_space,
    columns_on_blade,
    lengthen_cells,
)

_PIECES = 512  # number of pieces of the tables of hub and casing
_COLUMNS = 8  # columns of the table of channel.h: hub, vector to the casing, fractions at up to four heights
_NEWTON = 12
_LEAST_GAP = 1e-6  # narrowest gap, in spans: narrower cells would vanish in the rounding of radii
_FOOT_STEPS = 6
_SAME = 1e-13  # of the distance to a wall, relative to the gap


@dataclass(frozen=True, eq=False)
class MeridionalMap:
    """The conformal coordinate m' on a surface of revolution, defined by dm' = dm / r.

    m is the arc length of the meridian, and r the distance from the axis. Wu, NACA TN 2604 (1952).
    """

    forward: CubicTable  # function from s (n,) to m' (n,)
    back: CubicTable  # function from m' (n,) to s (n,)

    @property
    def length(self) -> float:
        """Length of the channel in the coordinate m', the integral of arc length divided by radius."""
        return float(self.forward.values[-1])


class Channel:
    """The channel between hub and casing, which maps (s, h) to x and the radius r.

    s is 0 at the inlet and 1 at the outlet. h is 0 at the hub and 1 at the casing.

    Parameters
    ----------
    hub, casing : points (n, 2) of x and r, from inlet to outlet.
    hub_gap, tip_gap : distances of the blade from hub and casing, in the unit of the curves.

    Raises InputError: points that are no curve; a curve that touches the axis; hub and casing that touch;
    gaps that leave no room for the blade.
    """

    def __init__(self, hub: Floats, casing: Floats, hub_gap: float = 0.0, tip_gap: float = 0.0) -> None:
        s = np.linspace(0.0, 1.0, _PIECES + 1)
        low, high = (_by_arc(points, s, name) for points, name in ((hub, "hub"), (casing, "shroud")))
        for name, points in (("hub", low), ("casing", high)):
            if not points[:, 1].min() > 0.0:
                raise InputError(f"the {name} reaches the axis, r = {points[:, 1].min():.6g}", "give r > 0")
        self.hub, self.across = CubicTable(low, s), CubicTable(high - low, s)
        widths = norms(high - low)
        _check_sides(low, high)
        self.radii = float(low[:, 1].min()), float(high[:, 1].max())
        self.span, self.widest = middle(widths), float(widths.max())
        self.length = middle(np.array([norms(np.diff(line, axis=0)).sum() for line in (low, high)]))
        self._check_gaps({"tip_gap": tip_gap, "hub_gap": hub_gap}, float(widths.min()))
        self.foot, self.tip = hub_gap / self.span, 1.0 - tip_gap / self.span
        self._levels, parts = [0.0], [np.zeros(_PIECES + 1)]
        if hub_gap > 0.0:
            self._levels.append(self.foot)
            parts.append(self._offset(s, hub_gap, from_casing=False))
        if tip_gap > 0.0:
            self._levels.append(self.tip)
            parts.append(1.0 - self._offset(s, tip_gap, from_casing=True))
        self._levels.append(1.0)
        parts.append(np.ones(_PIECES + 1))
        self._parts = [CubicTable(part, s) for part in parts]
        columns = np.zeros((_PIECES + 1, _COLUMNS))
        columns[:, : 4 + len(parts)] = np.concatenate([low, high - low, np.stack(parts, axis=1)], axis=1)
        cubics = np.ascontiguousarray(CubicTable(columns, s).unit_cubics().swapaxes(0, 1))
        self._tables = cubics, np.array(self._levels)

    def _check_gaps(self, gaps: dict[str, float], width: float) -> None:
        for place, gap in gaps.items():
            if 0.0 < gap < _LEAST_GAP * self.span:
                problem = f"{gap:g} is less than {_LEAST_GAP:g} of the span of {self.span:.6g}"
                raise InputError(problem, "use 0 for no gap, or a wider one", place=place)
        both = sum(gaps.values())
        if not both < 0.5 * width:
            problem = f"gaps of {both:g} in a channel {width:g} wide"
            widest = max(gaps, key=lambda place: gaps[place])
            raise InputError(problem, "use less than half of the span", place=widest)

    def _part(self, k: int, s: Floats) -> Floats:
        if k in (0, len(self._levels) - 1):
            return np.full(s.shape, float(k > 0))
        return self._parts[k](s)

    def at(self, s: Floats, h: Floats) -> Floats:
        """Return x and radius (..., 2) for coordinates `s` along and `h` across the channel (...)."""
        out = np.empty((s.size, 2))
        channel_points(
            self._tables, np.ascontiguousarray(s).reshape(-1), np.ascontiguousarray(h).reshape(-1), out
        )
        return out.reshape(*s.shape, 2)

    def in_space(self, values: Floats) -> Floats:
        """Return x, y, z (..., 3) of points s, theta, h (..., 3): along, around and across the channel."""
        out = np.empty(values.shape)
        channel_space(self._tables, np.ascontiguousarray(values).reshape(-1, 3), out.reshape(-1, 3))
        return out

    def store(self, values: Floats, ids: Indices, space: Floats) -> None:
        """Write x, y, z of points into `space` (levels, n, 3), at the indices `ids` (m,) of its second axis.

        `values` (levels, m, 3) are s, theta, h of these points: along, around and across the channel.
        """
        channel_nodes(self._tables, values, ids, space)

    def lengthen(self, begin: Floats, end: Floats, sizes: Floats) -> None:
        """Move the points `end` (..., 3), in place, to the distances `sizes` (...) from `begin` (..., 3).

        Points are s, theta, h: along, around and across the channel. Distances are measured in x, y, z.
        """
        lengthen_cells(self._tables, begin.reshape(-1, 3), sizes.reshape(-1), end.reshape(-1, 3))

    def put_on_blade(self, columns: Floats, wall: Floats, first: float) -> None:
        """Move columns of nodes, in place, to begin on the blade with first cells of height `first`.

        `columns` (..., rows, 3) are s, theta, h of nodes: along, around and across the channel. `wall` (...,
        2) are s, theta of their new first nodes. Displacements fade to 0 at the last node of a column.
        """
        flat = columns.reshape(-1, *columns.shape[-2:])
        columns_on_blade(self._tables, wall.reshape(-1, 2), first, flat)

    def places(self, points: Floats) -> tuple[Floats, Floats]:
        """Return s (0 inlet, 1 outlet) and h (0 hub, 1 casing), both (...), of points x, r (..., 2)."""
        p = points.reshape(-1, 2)
        s = self._nearest_line(p)
        part = np.zeros(len(p))
        for _ in range(_NEWTON):
            across = self.across(s)
            off = self.hub(s) + part[:, None] * across - p
            along = self.hub.slope(s) + part[:, None] * self.across.slope(s)
            area = cross2(along, across)
            s = s - cross2(off, across) / area
            part = part - cross2(along, off) / area
        h = self._heights(s, part)
        return s.reshape(points.shape[:-1]), h.reshape(points.shape[:-1])

    def _nearest_line(self, p: Floats) -> Floats:
        """Return s (n,) of the lines from hub to casing nearest to points (n, 2)."""
        knots = self.hub.knots[:: _PIECES // 128]
        low, way = self.hub(knots), self.across(knots)
        off = p[:, None] - low
        side = (off[..., 0] * way[:, 1] - off[..., 1] * way[:, 0]) / norms(way)
        return np.asarray(knots[np.abs(side).argmin(axis=1)])

    def _heights(self, s: Floats, part: Floats) -> Floats:
        """Return h (n,) at fractions (n,) of the way from hub to casing, also outside."""
        inside = np.clip(s, 0.0, 1.0)
        steps = np.stack([self._part(k, inside) for k in range(len(self._levels))])
        zone = np.clip((part >= steps).sum(axis=0) - 1, 0, len(steps) - 2)
        column = np.arange(len(s))
        low, high = steps[zone, column], steps[zone + 1, column]
        levels = np.array(self._levels)
        return np.asarray(levels[zone] + (part - low) / (high - low) * (levels[zone + 1] - levels[zone]))

    def meridional(self, h: float) -> MeridionalMap:
        """Return the map from s (0 inlet, 1 outlet) to conformal m' and back, at height `h` (casing: 1)."""
        s = self.hub.knots
        points = self.at(s, np.full(s.shape, h))
        speed = norms(CubicTable(points, s).slope(s)) / points[:, 1]
        m = CubicTable(speed, s).integrals()
        return MeridionalMap(CubicTable(m, s), CubicTable(s, m))

    def _offset(self, s: Floats, gap: float, *, from_casing: bool) -> Floats:
        """Return the fractions (n,) of the way from a wall at which points are a gap away from it."""
        low, way = self.hub.values, self.across.values
        wall = CubicTable(low + way, s) if from_casing else self.hub
        start, way = wall.values, (-way if from_casing else way)
        part = gap / norms(way)
        for _ in range(_NEWTON):
            away = _distance(start + part[:, None] * way, wall, s)
            if np.abs(away / gap - 1.0).max() < _SAME:
                break
            part = part * (gap / away)
        return np.asarray(part)

    @cached_property
    def levels(self) -> tuple[float, ...]:
        """Heights, 0 at the hub to 1 at the casing, of both walls and of blade ends at gaps; ascending."""
        return tuple(self._levels)


def _distance(points: Floats, wall: CubicTable, s: Floats) -> Floats:
    """Return the distances (n,) of points (n, 2) from a wall near s (n,)."""
    at = s
    for _ in range(_FOOT_STEPS):
        slope = wall.slope(at)
        at = at + ((points - wall(at)) * slope).sum(axis=1) / (slope**2).sum(axis=1)
    return norms(points - wall(at))


def _by_arc(points: Floats, s: Floats, name: str) -> Floats:
    with in_place(name):
        curve = Curve(apart(np.ascontiguousarray(points, dtype=np.float64), closed=False))
    return curve.at(s * curve.length)


def _beside(low: Floats, high: Floats) -> Floats:
    """Return (2, n), positive where the way from wall `low` to `high` (n, 2) leads to the left of both."""
    piece = [*range(_PIECES), _PIECES - 1]
    return np.stack([cross2(np.diff(line, axis=0)[piece], high - low) for line in (low, high)])


def _check_sides(hub: Floats, shroud: Floats) -> None:
    left = _beside(hub, shroud)
    if (left > 0.0).all():
        return
    for name, low, high in (("hub", hub[::-1], shroud), ("shroud", hub, shroud[::-1])):
        if (_beside(low, high) > 0.0).all():
            raise InputError("runs from outlet to inlet", "give its points from inlet to outlet", place=name)
    if (_beside(shroud, hub) > 0.0).all():
        inner, outer = (f"{wall[:, 1].min():.6g} to {wall[:, 1].max():.6g}" for wall in (hub, shroud))
        if hub[:, 1].mean() > shroud[:, 1].mean():
            problem = f"the hub is outside, at r = {inner}, the shroud at {outer}"
            raise InputError(problem, "exchange them, or give both in one unit")
        problem = "hub and shroud run from outlet to inlet, or the axis points the other way"
        raise InputError(problem, "give both from inlet to outlet, or the axis with the other sign")
    k = int(left.min(axis=0).argmin())
    problem = f"hub and casing cross or turn back near x = {hub[k, 0]:.6g}"
    raise InputError(problem, "check the axis, and give both from inlet to outlet, the hub inside")
