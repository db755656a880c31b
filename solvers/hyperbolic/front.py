"""The front of a march, which is the wall, or wake, wall and wake; and the distance to march.

The far field of an ``o`` front is a circle, that of a ``c`` front half a circle with two straight sides, both
of the area of the boundary's far field.
"""

import math

import numpy as np

from meshonet.geometry.arrays import Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.shapes.wake import rise
from meshonet.solvers.hyperbolic.level_spacing import Edge, level_steps, sharpest_edge
from meshonet.solvers.hyperbolic.settings import RISING, MarchSettings

_OPENING = 5.0  # a, the growth of first cells far behind the edge, in wall cells per chord
_NEAR = 0.3  # b; first cells x chords behind the edge are 1 + a x²/(x + b) wall cells high, plus `rise`
_CLOSED_AHEAD, _ASIDE, _OPEN_AHEAD, _OPEN_MORE = 1.8, 0.055, 23.0, 0.015
"""Corrections of the distance of levels relative to those around a circle, fitted on airfoils to 1 %."""


class Front:
    """The first nodes of a march, on a body or on body and wake, and the distance to march."""

    inner: float  # radius of the circle of the body's area
    slender: float  # 1 - l/L, with the perimeters L of the body and l of a circle of the same area
    outer: float  # radius of the far field: least distance of the last level from the centre of the body
    ends: Floats | None  # (2, 2) unit directions in which the ends of an open front move
    widening: Floats | None  # (n,) factors of the first step, relative to the wall, for an open front
    edge: Edge | None  # the sharpest corner of a closed front
    narrow: bool  # it has corners of a base, where cells along it are as short as first cells are high
    concave: bool  # some of them turn towards the grid

    def __init__(
        self, boundary: Boundary, first: float, wake: int = 0, widening: Floats | None = None, *,
        concave: bool = False,
    ) -> None:  # fmt: skip
        """Take an ``o`` or ``c`` boundary, or a ``quad`` with `wake` wake cells at both ends of south.

        `first` is the first-cell height at the wall, `widening` (wake + 1,) its factors along the wake.
        """
        self._south, self.concave, self.narrow = boundary.south, concave, wake > 0
        self._closed = boundary.periodic
        self.ends = self.widening = None
        self.slender, self.edge = 0.0, None
        if self._closed:
            self.edge = sharpest_edge(boundary.south[:-1])
            self.inner, self.outer = _radius(boundary.south[:-1]), _radius(boundary.north[:-1])
            self._middle = _middle(boundary.south)
            perimeter = float(np.hypot(*np.diff(boundary.south, axis=0).T).sum())
            self.slender = 1.0 - 2.0 * math.pi * self.inner / perimeter
            return
        sides = boundary.west[-1] - boundary.west[0], boundary.east[-1] - boundary.east[0]
        self.ends = np.array([side / np.hypot(*side) for side in sides])
        self._wake = (wake or boundary.wake) + 1
        if widening is None:
            edge = self._south[self._wake - 1]
            behind = np.hypot(*(self._south[: self._wake] - edge).T) / boundary.chord
            widening = opening(behind, rise(behind) / (first / boundary.chord))[::-1]
        self.widening = np.ones(len(self._south))
        self.widening[: self._wake] = widening[::-1]
        self.widening[len(self._south) - self._wake :] = widening
        body = self._south[self._wake - 1 : len(self._south) - self._wake + 1]
        self.inner = 0.5 * math.sqrt(abs(polygon_area(body)) / math.pi)
        self._middle = _middle(body)
        self._behind = float(0.5 * np.hypot(*(self._south[[0, -1]] - self._middle).T).sum())
        self.outer = self._far(boundary.north)

    def start(self) -> Floats:
        """Return the nodes (n, 2) of level 0; the repeated node of a closed front is left out."""
        return self._south[:-1] if self._closed else self._south

    def reach(self, levels: Floats) -> float:
        """Return the least distance from the body's centre to a node on the last of m `levels` (2, m, n)."""
        return float(np.hypot(*(levels[:, -1].T - self._middle).T).min())

    def nodes(self, levels: Floats) -> Floats:
        """Return m marched `levels` (2, m, n) as nodes (ni, m, 2); ni is n + 1 in an O grid, else n."""
        n = levels.shape[2]
        nodes = planar_nodes(n + self._closed, levels.shape[1])
        nodes[:n] = levels.T
        return nodes

    def close(self, nodes: Floats) -> None:
        """Copy the first line of a closed grid to its last line, in place."""
        if self._closed:
            nodes[-1] = nodes[0]

    def heights(self, first: float) -> Floats:
        """Return the first-cell heights (ni,): `first` at the wall, and more along a wake."""
        if self.widening is None:
            return np.full(len(self._south), first)
        return first * self.widening

    def _far(self, north: Floats) -> float:
        """Return the radius of a C as large as the area up to `north`."""
        area = abs(polygon_area(np.concatenate([self._south[[-1]], north[::-1], self._south[[0]]])))
        # Half a circle and two sides L: πR²/2 + 2RL.
        b = 2.0 * self._behind / math.pi
        return math.sqrt(b * b + 2.0 * area / math.pi) - b


def opening(behind: Floats, higher: Floats) -> Floats:
    """Return the heights (n,) of first cells along a wake, divided by the first-cell height at the wall.

    `behind` (n,) are distances behind the trailing edge, in chords. `higher` (n,) is added to the results.
    """
    return np.asarray(1.0 + _OPENING * behind**2 / (behind + _NEAR) + higher)


def _radius(ring: Floats) -> float:
    """Return the radius of the circle with the area of a closed polygon (n, 2)."""
    return math.sqrt(abs(polygon_area(ring)) / math.pi)


def _middle(wall: Floats) -> Floats:
    """Return the midpoint (2,) of the first node of a wall (n, 2) and the farthest node."""
    farthest = wall[np.argmax(np.hypot(*(wall - wall[0]).T))]
    return np.asarray(0.5 * (wall[0] + farthest))


def distance_to_march(
    front: Front, first: float, cells: int, settings: MarchSettings, constant: int, edge: Edge | None
) -> float:
    """Return the sum of the steps of a march whose last level reaches the far field.

    Levels of the marched grid advance by less than the steps, as they become longer and are smoothed. On a
    circle of radius r, a step s increases r by s (1 - e)/(1 + f s/r + 2 e s/r). Here e is the coefficient of
    the smoothing and f is 1 + `settings.theta`. Other bodies get corrections fitted on airfoils.
    """
    distance = front.outer - front.inner
    around = 2.0 * math.pi * settings.dissipation / len(front.start())
    powers = (2.0 / np.sqrt(np.minimum(np.arange(cells) + 1.0, round(RISING * cells)) / cells)).tolist()
    for _ in range(8):
        before = r = front.inner
        height = 0.0
        steps = level_steps(first, distance, cells, constant, edge).tolist()
        for step, power in zip(steps, powers, strict=True):
            height += step
            slow = min(around * max((before / r) ** power, 0.1) + settings.bend * height / r, 0.1)
            part = step * (1.0 - slow) / (1.0 + (1.0 + settings.theta + 2.0 * slow) * step / r)
            before, r = r, r + part
        if abs(r - front.outer) < 3e-3 * front.outer:
            break
        distance *= (front.outer - front.inner) / (r - front.inner)
    rate = math.log(steps[-1] / steps[-2]) if cells > 1 else 0.0
    if front.ends is not None:
        return (1.0 + _OPEN_MORE) * distance / (1.0 + _OPEN_AHEAD * rate**3)
    ahead = min(_CLOSED_AHEAD * front.slender * rate**2, 0.1)
    return distance * (1.0 + _ASIDE * front.slender - ahead)
