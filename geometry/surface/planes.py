"""Planes of symmetry, found from open edges of a surface: normal to an axis, with the surface on one side."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, extent_of, norms
from meshonet.geometry.elementary import arctan2

FLAT = 1e-6  # largest distance of nodes from a plane of symmetry, divided by the size of the surface
FEWEST = 3  # smallest number of open edges in a plane of symmetry
SLANT_DEG = 5.0
"""Largest angle, in degrees, between a surface that encloses no volume and the normal of a plane of symmetry.

Its mirror image must continue it smoothly; half a closed body may meet its own at an edge.
"""


@dataclass(frozen=True)
class Plane:
    """The plane of all points whose coordinate number `axis` (0, 1, 2) is `value`."""

    axis: int
    value: float

    def __str__(self) -> str:
        return f"{'xyz'[self.axis]} = {self.value:.6g}"


def planes_of(nodes: Floats, sides: Indices) -> tuple[Plane, ...]:
    """Return the planes of constant x, y or z that bound a surface and contain some of its open edges.

    `sides` is the result of `open_sides`. An edge in several planes counts for the plane with the most edges.
    Planes with fewer than `FEWEST` edges, such as blunt trailing edges, are left out.
    """
    if not len(sides):
        return ()
    size = extent_of(nodes)
    left = np.ones(len(sides), dtype=bool)
    ends = [
        Plane(axis, float(end)) for axis in range(3) for end in (nodes[:, axis].min(), nodes[:, axis].max())
    ]
    planes: list[Plane] = []
    while True:
        inside = [edges_in(nodes, sides, plane, FLAT * size) & left for plane in ends]
        most = max(inside, key=lambda flags: int(flags.sum()))
        if most.sum() < FEWEST:
            return tuple(planes)
        axis = ends[next(k for k, flags in enumerate(inside) if flags is most)].axis
        exact = float(np.median(nodes[sides[most, :2], axis]))
        planes.append(Plane(axis, 0.0 if abs(exact) <= 1e-12 * size else exact))
        left &= ~most


def edges_in(nodes: Floats, sides: Indices, plane: Plane, slack: float) -> Indices:
    """Return a mask (k,) of open edges that are within `slack` of a plane, but whose quads are not.

    `sides` (k, 4), from `open_sides`, are the corners of these quads; the ends of the open edge come first.
    """
    near = np.abs(nodes[sides, plane.axis] - plane.value) <= slack
    return np.asarray(near[:, :2].all(axis=1) & ~near[:, 2:].all(axis=1))


def slant(nodes: Floats, sides: Indices, plane: Plane) -> float:
    """Return the mean angle, in degrees, between the normal of `plane` and faces with open edges in it."""
    mine = sides[edges_in(nodes, sides, plane, FLAT * extent_of(nodes))]
    a, b, c, d = (nodes[mine[:, k]] for k in range(4))
    normal = np.cross(c - a, d - b)
    across = np.abs(normal[:, plane.axis])
    within = norms(np.delete(normal, plane.axis, axis=1))
    return float(np.degrees(arctan2(across, within)).mean())
