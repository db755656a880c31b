"""A section of a blade row as a plane cascade with the pitch 2 pi / blades."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, complex_of, pairs_of, read_only, wrapped
from meshonet.geometry.cached import cached_property
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import modulus
from meshonet.geometry.rows.blade import BladeSurface, clustered
from meshonet.geometry.rows.channel import MeridionalMap
from meshonet.geometry.rows.row import Row
from meshonet.solvers.cascade.cascade import Cascade
from meshonet.solvers.layers.layer_settings import LayerSettings

_AROUND = 400  # number of points of a section
_SHARES = np.array([-1.0, 0.0, 1.0, 2.0])
STEEPEST = 45.0  # largest angle to the axis in degrees at which lines follow a wake; cells are skewed by it
ON_SIDE = read_only(np.linspace(0.0, 0.5, 201))
"""Places on the upper side for which the places opposite them across the channel are computed."""
_EDGE = 3  # of these at both edges have nothing opposite them
_AT_EDGE = 0.1  # of the way along the blade, before and behind an edge
_NEAR_EDGE = 0.06  # places before and behind the trailing edge by which the mean line is known there


@dataclass(frozen=True, eq=False)
class SectionPlane:
    """A section of a blade row, mapped to a plane cascade.

    A place on the blade is given by the coordinate u. It is 0 at the leading edge, increases to 0.5 at the
    trailing edge along the upper side, then to 1 along the lower side.
    """

    height: float  # height h in the channel, 0 at the hub to 1 at the casing
    map: MeridionalMap  # map between s and m'
    cascade: Cascade  # the cascade in (m', theta)
    places: Floats  # (n,) ascending places u of the points of the cascade's blade

    @classmethod
    def of(cls, row: Row, height: float, first: float, growth: float, share: float = 1.0) -> Self:
        """Return the section at `height`, from 0 at the hub to 1; `share` is a factor on layer thickness."""
        u, lines = _lines(row.surface)
        s, theta = row.surface.crossings(lines, np.full(len(u), height)).T
        to = row.channel.meridional(height)
        points = np.stack([to.forward(s), theta], axis=1)
        corners = np.flatnonzero(np.isin(u, row.surface.corners))
        edges = tuple(corners.tolist())
        loop = Loop(Curve(points, closed=True, corners=corners), edges, ("blade",))
        low, high = float(points[:, 0].min()), float(points[:, 0].max())
        radii = row.channel.at(s, np.full(len(s), height))[:, 1]
        settings = LayerSettings(first / float(radii.max()), growth)
        chord, pitch = high - low, (0.0, 2.0 * np.pi / row.blades)
        cascade = Cascade(
            loop,
            pitch,
            low / chord,
            (to.length - high) / chord,
            settings,
            row.name,
            factors=radii.max() / radii,
            share=share,
        )
        return cls(height, to, cascade, u)

    @property
    def room(self) -> tuple[float, float]:
        """Distances in pitches from the blade with its wall layers to the inlet, and to the outlet."""
        before, behind = self.cascade.ends
        return before / self.cascade.pitch[1], behind / self.cascade.pitch[1]

    @property
    def thickest(self) -> float:
        """Coordinate u, from 0 to 0.5 along the upper side of the blade, where the section is thickest."""
        u = np.linspace(0.1, 0.4, 61)
        return float(u[int(modulus(self._opposite(u) - self._opposite(1.0 - u)).argmax())])

    def _opposite(self, u: Floats) -> Complexes:
        return complex_of(self.cascade.blade.at(self.wall_arcs(u)))

    @cached_property
    def edges(self) -> Floats:
        """Coordinates m' (see `MeridionalMap`) and theta of the leading and of the trailing edge, (2, 2)."""
        return self.cascade.blade.at(self.wall_arcs(np.array([0.0, 0.5])))

    @property
    def wake(self) -> float:
        """Increase of theta from the trailing edge to the outlet, along a straight line.

        The line continues the mean line of the blade, at an angle of at most `STEEPEST` degrees to the axis.
        """
        one, other = self._opposite(np.array([0.5 - _NEAR_EDGE, 0.5 + _NEAR_EDGE]))
        way = complex(*self.edges[1]) - complex(0.5 * (one + other))
        most = math.tan(math.radians(STEEPEST))
        slope = min(max(way.imag / way.real, -most), most) if way.real > 0.0 else 0.0
        return slope * (self.map.length - float(self.edges[1, 0]))

    def ending(self, near: tuple[float, float], thickest: float) -> Self:
        """Return the section with straight grid lines at inlet and outlet.

        Lines are straight beyond the distances `near` (in pitches) upstream and downstream of the blade's
        layers. The blade is thickest at u = `thickest`; u is 0 at the leading and 0.5 at the trailing edge.
        """
        one, other = self._opposite(np.array([thickest, 1.0 - thickest]))
        centre = complex(0.5 * (one + other))
        return replace(self, cascade=self.cascade.ending(near, centre))

    @property
    def corners(self) -> Floats:
        """Places u (c,) of the blade's corners, from 0 to 1 around the blade."""
        return self.places[list(self.cascade.blade.corners)]

    def from_corners(self, arcs: Floats) -> Floats:
        """Return distances along the blade from its arc lengths `arcs` (n,) to the nearest corner, or inf."""
        off = wrapped((arcs - self.wall_arcs(self.corners)[:, None]) / self._walls[-1])
        return np.asarray(self._walls[-1] * np.abs(off).min(axis=0, initial=np.inf))

    @cached_property
    def _walls(self) -> Floats:
        return np.append(self.cascade.blade.curve.knots, self.cascade.blade.length)

    def wall_arcs(self, u: Floats) -> Floats:
        """Return the arc lengths (n,) on the blade at places `u` (n,), which run from 0 to 1 around it."""
        return np.interp(u, np.append(self.places, 1.0), self._walls)

    def places_of(self, arcs: Floats) -> Floats:
        """Return the places u (n,), from 0 to 1 around the blade, at arc lengths `arcs` (n,) on it."""
        return np.interp(np.mod(arcs, self._walls[-1]), self._walls, np.append(self.places, 1.0))

    def front_arcs(self, u: Floats) -> Floats:
        """Return where grid lines leave the blade's layers, as arc lengths (n,) on the layers' outer edge.

        The lines begin on the blade, at places `u` (n,) from 0 to 1 around it.
        """
        ring = self.cascade.ring
        length, start = self._walls[-1], ring.arcs[0]
        walls = np.append(ring.arcs, start + length)
        front = np.append(ring.front.curve.knots, ring.front.length)
        along = np.interp(start + np.mod(self.wall_arcs(u) - start, length), walls, front)
        return np.asarray(np.mod(along, ring.front.length))

    @cached_property
    def across(self) -> tuple[Floats, Floats]:
        """Points opposite each other on neighbouring blades, and how near to each other they are.

        Positions u are 0 at a blade's leading edge, rise to 0.5 at the trailing edge along the upper side,
        then to 1 along the lower side. `ON_SIDE` has n positions on the upper side. The first array (n,) has
        1 - u of the opposite points, on the lower side of the next blade. The second (n,) is the perimeter
        divided by the distance between both blades' layers, or 0 where nothing is opposite.
        """
        front, pitch = self.cascade.ring.front, np.array([0.0, self.cascade.pitch[1]])
        one, other = (front.at(self.front_arcs(u)) for u in (ON_SIDE, 1.0 - ON_SIDE))
        off = ((other + pitch).T[:, None] - one.T[:, :, None]) ** 2
        away = off[0] + off[1]
        k = away.argmin(axis=1)
        inside = (k >= _EDGE) & (k < len(ON_SIDE) - _EDGE)
        k, row = np.clip(k, 1, len(ON_SIDE) - 2), np.arange(len(ON_SIDE))
        before, here, after = away[row, k - 1], away[row, k], away[row, k + 1]
        shift = 0.5 * (before - after) / (before - 2.0 * here + after)
        lower = ON_SIDE[k] + np.clip(shift, -0.5, 0.5) * ON_SIDE[1]
        return lower, np.where(inside, self.cascade.blade.length / np.sqrt(here), 0.0)

    def place(self, point: Floats) -> str:
        """Return text for users: this section's height, and where `point` (2,) is along the passage."""
        share = float(self.shares(point[None])[0])
        along = f"between the blades, {100.0 * share:.0f} % of the way along them"
        if share < _AT_EDGE:
            along = "at the leading edge" if share > -_AT_EDGE else "before the blades"
        elif share > 1.0 - _AT_EDGE:
            along = "at the trailing edge" if share < 1.0 + _AT_EDGE else "behind the blades"
        return f"section at {100.0 * self.height:.3g} % of the span, {along}"

    def shares(self, points: Floats) -> Floats:
        """Return positions (n,) of `points` (n, 2): -1 at the inlet, 0 and 1 at blade edges, 2 at outlet."""
        return np.interp(points[:, 0], self._stations, _SHARES)

    def stations(self, shares: Floats) -> Floats:
        """Return m' along the flow at `shares` (n,), -1 (inlet) to 2 (outlet); blade edges are 0 and 1."""
        return np.interp(shares, _SHARES, self._stations)

    def camber(self, shares: Floats) -> Floats:
        """Return the coordinate theta (n,) of the mean line at `shares` (n,): 0 leading, 1 trailing edge."""
        u = np.linspace(0.0, 0.5, _AROUND)
        middle = 0.5 * (self._opposite(u) + self._opposite(1.0 - u))
        part = np.maximum.accumulate(self.shares(pairs_of(middle)))
        return np.interp(np.clip(shares, 0.0, 1.0), part, middle.imag)

    @property
    def _stations(self) -> Floats:
        """M' of inlet, leading edge, trailing edge and outlet."""
        return np.array([0.0, self.edges[0, 0], self.edges[1, 0], self.map.length])


@lru_cache(maxsize=8)
def _lines(surface: BladeSurface) -> tuple[Floats, CubicTable]:
    """Return places around a section, corners among them, and the surface's lines there."""
    u = read_only(_with_corners(clustered(_AROUND), surface.corners))
    return u, surface.lines(u)


def _with_corners(u: Floats, corners: Floats) -> Floats:
    u = u.copy()
    for corner in corners:
        k = int(np.abs(u - corner).argmin())
        if k or corner != 0.0:
            u[k or int(np.abs(u[1:] - corner).argmin()) + 1] = corner
    return u
