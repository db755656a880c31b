"""Target lengths of edges, depending on position and direction, from the requirements of walls and fronts."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.kernels._native import nearest_points

GRADING = 0.13  # largest growth of edge lengths per distance from a wall
SWEEPS = 20  # number of sweeps that smooth the target lengths


@dataclass(frozen=True, eq=False)
class Near:
    """The points on walls that determine the target lengths of the edges of a mesh."""

    point: Indices  # (p, m) nearest point to each of m edges, for each of p parts
    distance: Floats  # (p, m) distance to this point
    square: Floats  # (p, m) squared cosine of the angle between the edge and the normal at this point

    def length(self, sizes: "SizeMetric") -> Floats:
        """Return the target lengths (m,) of m edges, from the target lengths `sizes` at points on walls.

        If several metrics were joined into `sizes`, the smallest of their lengths counts.
        """
        rise = sizes.grading * self.distance
        high = np.minimum(sizes.across[self.point] + rise, sizes.largest)
        wide = np.minimum(sizes.along[self.point] + rise, sizes.largest)
        most = np.sqrt(self.square / high**2 + (1.0 - self.square) / wide**2).max(axis=0)
        return np.asarray(1.0 / most)


@dataclass(frozen=True, eq=False)
class SizeMetric:
    """Target lengths of edges, which depend on place and direction.

    The target lengths across and along a wall are the half axes of an ellipse. In any other direction, the
    target length is the radius of the ellipse.
    """

    points: Floats  # (n, 2) points on walls and fronts
    normals: Floats  # (n, 2) unit normals at the points
    across: Floats  # (n,) target lengths of edges along the normal
    along: Floats  # (n,) target lengths of edges along the wall
    largest: float  # length of edges far from all points
    grading: float = GRADING  # increase of the target length per distance from a point
    starts: tuple[int, ...] = (0,)  # first points of parts; edges have the least length of all parts

    @classmethod
    def joined(cls, metrics: "Sequence[SizeMetric]") -> "SizeMetric":
        """Return a metric that satisfies all `metrics`: at each place, the smallest of their sizes."""
        starts = np.cumsum([0, *(len(each.points) for each in metrics[:-1])])
        points, normals, across, along = (
            np.concatenate([getattr(each, name) for each in metrics])
            for name in ("points", "normals", "across", "along")
        )
        largest = min(each.largest for each in metrics)
        return cls(points, normals, across, along, largest, metrics[0].grading, tuple(starts.tolist()))

    def length(self, places: Floats, directions: Floats) -> Floats:
        """Return target lengths (m,) of edges, from midpoints `places` and vectors `directions` (m, 2)."""
        return self.near(places, directions).length(self)

    def near(self, places: Floats, directions: Floats) -> Near:
        """Return the wall point nearest to each edge, its distance, and the edge's angle to the normal there.

        `places` (m, 2) are the midpoints of the edges, `directions` (m, 2) their directions. If this metric
        was joined from several, each of them gives its own nearest point for each edge.
        """
        places = np.ascontiguousarray(places)
        size = np.maximum(np.hypot(directions[:, 0], directions[:, 1]), 1e-300)
        shape = len(self.starts), len(places)
        point, away, square = np.empty(shape, dtype=np.intp), np.empty(shape), np.empty(shape)
        for part, (start, stop) in enumerate(pairwise((*self.starts, len(self.points)))):
            k, squares = nearest_points(places, self.points[start:stop])
            k += start
            distance = np.sqrt(squares)
            cosine = np.abs((directions * self.normals[k]).sum(axis=1)) / size
            point[part], away[part], square[part] = k, distance, cosine**2
        return Near(point, away, square)

    def edges(self, mesh: QuadMesh) -> Floats:
        """Return the target lengths (e,) of the edges of a mesh in their present positions."""
        first, second = mesh.nodes[mesh.edges].transpose(1, 0, 2)
        return self.length(0.5 * (first + second), second - first)

    def gradual(self, mesh: QuadMesh, sweeps: int = SWEEPS) -> Floats:
        """Return the target lengths (e,) of the edges of a mesh, smoothed over neighbouring edges."""
        return _evened(self.edges(mesh), mesh, sweeps)


def _evened(lengths: Floats, mesh: QuadMesh, sweeps: int) -> Floats:
    """Return the lengths (e,) with each that is not at a wall the geometric mean of it and those beside."""
    logs, count = log(lengths), len(mesh.edges)
    rungs = np.concatenate([mesh.edge_of[:, [0, 2]], mesh.edge_of[:, [1, 3]]])
    rungs = np.concatenate([rungs, rungs[:, ::-1]])
    beside = np.bincount(rungs[:, 0], minlength=count)
    free = (beside == 2) & ~mesh.wall_nodes[mesh.edges].any(axis=1)
    for _ in range(sweeps):
        mean = np.bincount(rungs[:, 0], logs[rungs[:, 1]], minlength=count) / np.maximum(beside, 1)
        logs[free] = 0.5 * (logs + mean)[free]
    return exp(logs)
