"""What a march starts from and how far it goes: a closed wall, or wake, wall and wake.

::

    o: one ring, node after node; the far field is as large as a circle of the same area
    c: from outlet to outlet; the ends move along the outlet, the cells beside the wake may open, and the far
       field is as large as half a circle with two straight sides of the same area
"""

from __future__ import annotations

import math

import numpy as np

from meshonet.geometry.arrays import Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.polygon.area import polygon_area
from meshonet.solvers.hyperbolic.level_spacing import Edge, sharpest_edge

_OPENING = 5.0
_NEAR = 0.3
"""First cells beside a wake are higher than at the wall by 1 + 5 x²/(x + 0.3), x chords behind the edge."""


class Front:
    """Level 0 of a march and the measure of its last level.

    `boundary`: ``o`` or ``c``.
    """

    inner: float
    """Radius of the circle of the body's area."""
    slender: float
    """1 - l/L, with l the perimeter of the circle of the body's area and L its own: 0 for a circle."""
    outer: float
    """Radius of the far field."""
    ends: Floats | None
    """(2, 2) unit directions in which the ends of an open front move."""
    widening: Floats | None
    """(n,) how much larger than at the wall first steps are, for an open front."""
    edge: Edge | None
    """The sharpest corner of a closed front."""

    def __init__(self, boundary: Boundary) -> None:
        self._south = boundary.south
        self._closed = boundary.periodic
        self.ends = self.widening = None
        self.slender, self.edge = 0.0, None
        if self._closed:
            self.edge = sharpest_edge(boundary.south[:-1])
            self.inner, self.outer = _radius(boundary.south[:-1]), _radius(boundary.north[:-1])
            perimeter = float(np.hypot(*np.diff(boundary.south, axis=0).T).sum())
            self.slender = 1.0 - 2.0 * math.pi * self.inner / perimeter
            return
        sides = boundary.west[-1] - boundary.west[0], boundary.east[-1] - boundary.east[0]
        self.ends = np.array([side / np.hypot(*side) for side in sides])
        self._wake = boundary.wake + 1
        edge = self._south[self._wake - 1]
        behind = np.hypot(*(self._south[: self._wake] - edge).T) / boundary.chord
        opening = 1.0 + _OPENING * behind**2 / (behind + _NEAR)
        self.widening = np.ones(len(self._south))
        self.widening[: self._wake] = opening
        self.widening[len(self._south) - self._wake :] = opening[::-1]
        body = self._south[self._wake - 1 : len(self._south) - self._wake + 1]
        self.inner = 0.5 * math.sqrt(abs(polygon_area(body)) / math.pi)
        self._behind = float(0.5 * np.hypot(*(self._south[[0, -1]] - body.mean(axis=0)).T).sum())
        self.outer = self._far(boundary.north)

    def start(self) -> Floats:
        """Return the nodes (n, 2) of level 0, a closed one's first node not repeated."""
        return self._south[:-1] if self._closed else self._south

    def reach(self, levels: Floats) -> float:
        """Return how far the last of `levels` (2, m, n) is away: a length to compare with `outer`."""
        last = levels[:, -1].T
        return _radius(last) if self._closed else self._far(last)

    def curved(self, radius: float) -> float:
        """Return the part of a level of that radius that is a circle: all, or all but the sides of a C."""
        half = math.pi * radius
        return 1.0 if self._closed else half / (half + 2.0 * self._behind)

    def nodes(self, levels: Floats) -> Floats:
        """Return `levels` (2, m, n) as nodes (ni, m, 2)."""
        n = levels.shape[2]
        nodes = planar_nodes(n + self._closed, levels.shape[1])
        nodes[:n] = levels.T
        return nodes

    def close(self, nodes: Floats) -> None:
        """Repeat the first line of a closed grid at the end, in place."""
        if self._closed:
            nodes[-1] = nodes[0]

    def heights(self, first: float) -> Floats:
        """Return the heights (ni,) of first cells, `first` at the wall."""
        if self.widening is None:
            return np.full(len(self._south), first)
        return first * self.widening

    def _far(self, north: Floats) -> float:
        """Return the radius R of a C up to `north`: half a circle and sides L have πR²/2 + 2RL."""
        area = abs(polygon_area(np.concatenate([self._south[[-1]], north[::-1], self._south[[0]]])))
        b = 2.0 * self._behind / math.pi
        return math.sqrt(b * b + 2.0 * area / math.pi) - b


def _radius(ring: Floats) -> float:
    """Return the radius of the circle with the area of a closed polygon (n, 2)."""
    return math.sqrt(abs(polygon_area(ring)) / math.pi)
