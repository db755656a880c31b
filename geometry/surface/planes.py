"""Planes of symmetry that the open edges of a surface show: normal to an axis, the surface on one side."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.surface.merge import size_of

FLAT = 1e-6
"""Part of the size of a surface by which nodes may be off a plane of symmetry."""
FEWEST = 3
"""Open edges in a plane, at least, that show it."""


@dataclass(frozen=True)
class Plane:
    """All points whose coordinate `axis` (0, 1, 2) is `value`."""

    axis: int
    value: float

    def __str__(self) -> str:
        return f"{'xyz'[self.axis]} = {self.value:.6g}"


def planes_of(nodes: Floats, edges: Indices, used: Indices) -> tuple[Plane, ...]:
    """Return the planes normal to an axis that `edges` (k, 2) lie in, with the nodes `used` on one side.

    A plane has at least `FEWEST` edges.
    """
    slack = FLAT * size_of(nodes)
    planes: list[Plane] = []
    if not len(edges):
        return ()
    for axis in range(3):
        along = nodes[used, axis]
        ends = nodes[edges, axis]
        for value in (float(along.min()), float(along.max())):
            inside = (np.abs(ends - value) <= slack).all(axis=1)
            if inside.sum() >= FEWEST:
                exact = float(np.median(ends[inside]))
                planes.append(Plane(axis, 0.0 if abs(exact) <= 1e-12 * size_of(nodes) else exact))
    return tuple(planes)


def edges_in(nodes: Floats, edges: Indices, plane: Plane, slack: float) -> Indices:
    """Return which (k,) of `edges` (k, 2) lie in a plane, to `slack`."""
    return np.asarray((np.abs(nodes[edges, plane.axis] - plane.value) <= slack).all(axis=1))
