"""The section of a blade row at a height as a plane cascade: places around the blade, and the way back.

On a surface of revolution (m', theta) with dm' = dm / r is conformal: angles are those in space, and the
passage is that of a plane cascade with the pitch 2 pi / blades.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, complex_of
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import modulus
from meshonet.geometry.rows.blade import clustered
from meshonet.geometry.rows.channel import MeridionalMap
from meshonet.geometry.rows.row import Row
from meshonet.solvers.blocking.cascade.cascade import Cascade
from meshonet.solvers.blocking.cascade.passage import BLADE
from meshonet.solvers.blocking.layers.layer_rows import LayerSettings

_AROUND = 400
"""Points of a section."""


@dataclass(frozen=True, eq=False)
class SectionPlane:
    """A section.

    Parameters
    ----------
    height : h of the channel.
    map : between s and m'.
    cascade : in (m', theta).
    places : (n,) u of the points of the cascade's blade, ascending from 0.
    """

    height: float
    map: MeridionalMap
    cascade: Cascade
    places: Floats

    @classmethod
    def of(cls, row: Row, height: float, first: float, growth: float) -> SectionPlane:
        """Return the section of a row, with layers whose first cells are `first` high in space."""
        u = _with_corners(clustered(_AROUND), row.surface.corners)
        s, theta = row.surface.section(height, u).T
        to = row.channel.meridional(height)
        points = np.stack([to.forward(s), theta], axis=1)
        corners = np.flatnonzero(np.isin(u, row.surface.corners))
        edges = tuple(corners.tolist())
        loop = Loop(Curve(points, closed=True, corners=corners), edges, ("blade",))
        low, high = float(points[:, 0].min()), float(points[:, 0].max())
        radius = float(row.channel.at(np.array([s.mean()]), np.array([height]))[0, 1])
        settings = LayerSettings(first / radius, growth)
        chord, pitch = high - low, (0.0, 2.0 * np.pi / row.blades)
        cascade = Cascade(loop, pitch, low / chord, (to.length - high) / chord, settings, row.name)
        return cls(height, to, cascade, u)

    @property
    def room(self) -> tuple[float, float]:
        """Pitches between the front of the layers and inlet and outlet."""
        before, behind = self.cascade.ends
        return before / self.cascade.pitch[1], behind / self.cascade.pitch[1]

    @property
    def thickest(self) -> float:
        """Place u on the upper side, 0 to 0.5, at which opposite points of both sides are farthest apart."""
        u = np.linspace(0.1, 0.4, 61)
        return float(u[int(modulus(self._opposite(u) - self._opposite(1.0 - u)).argmax())])

    def _opposite(self, u: Floats) -> Complexes:
        return complex_of(self.cascade.blade.at(self.wall_arcs(u)))

    @property
    def edges_aside(self) -> Floats:
        """Theta (2,) of the leading and the trailing edge, from the centre of the map."""
        edges = self.cascade.blade.at(self.wall_arcs(np.array([0.0, 0.5])))
        return np.asarray(edges[:, 1] - self.cascade.passage.map.centre.imag)

    def ending(self, near: tuple[float, float], thickest: float) -> SectionPlane:
        """Return the section with straight rows that begin `near` pitches before and behind the blade.

        The centre of its map is in the middle between both sides at the place `thickest`, so that maps of
        neighbouring sections differ little.
        """
        one, other = self._opposite(np.array([thickest, 1.0 - thickest]))
        centre = complex(0.5 * (one + other))
        return replace(self, cascade=replace(self.cascade, near=near, centre=centre))

    @property
    def corners(self) -> Floats:
        """Places u (c,) of the corners of the blade."""
        return self.places[list(self.cascade.blade.corners)]

    @cached_property
    def _walls(self) -> Floats:
        return np.append(self.cascade.blade.curve.knots, self.cascade.blade.length)

    def wall_arcs(self, u: Floats) -> Floats:
        """Return arc lengths (n,) of the blade at places u (n,), 0 to 1."""
        return np.interp(u, np.append(self.places, 1.0), self._walls)

    def places_of(self, arcs: Floats) -> Floats:
        """Return places u (n,) at arc lengths (n,) of the blade."""
        return np.interp(np.mod(arcs, self._walls[-1]), self._walls, np.append(self.places, 1.0))

    def image_arcs(self, u: Floats) -> Floats:
        """Return arc lengths (n,), in the plane of the passage's map, of the front above places u (n,)."""
        ring, passage = self.cascade.ring, self.cascade.passage
        length, start = self._walls[-1], ring.arcs[0]
        walls = np.append(ring.arcs, start + length)
        front = np.append(ring.front.curve.knots, ring.front.length)
        along = np.interp(start + np.mod(self.wall_arcs(u) - start, length), walls, front)
        image = passage.domain.loops[BLADE]
        knots = np.append(passage.front.curve.knots, passage.front.length)
        there = np.interp(along, knots, np.append(image.curve.knots, image.length))
        return np.asarray(np.mod(there, image.length))

    def places_under(self, image_arcs: Floats) -> Floats:
        """Return places u (n,) of the blade under arc lengths (n,) of the front, in the plane of the map."""
        ring = self.cascade.ring
        along = self.cascade.passage.front_arcs(image_arcs)
        front = np.append(ring.front.curve.knots, ring.front.length)
        arcs = np.interp(along, front, np.append(ring.arcs, ring.arcs[0] + self._walls[-1]))
        return self.places_of(arcs)


def _with_corners(u: Floats, corners: Floats) -> Floats:
    """Return places with those nearest to corners put there."""
    u = u.copy()
    for corner in corners:
        k = int(np.abs(u - corner).argmin())
        u[k or int(np.abs(u[1:] - corner).argmin()) + 1] = corner
    return u
