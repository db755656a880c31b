"""The triangles of a domain as a surface: neighbourhoods of vertices, walls, gradients.

Corner c = 3 f + i is corner i of triangle f; edge i of a triangle goes from its corner i to the next.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats, Indices, complex_of
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.elementary import angle, modulus, times
from meshonet.geometry.errors import SolverError
from meshonet.kernels._native import surface_fans

NEXT = np.array([1, 2, 0])  # corner of a triangle after each
PREVIOUS = np.array([2, 0, 1])  # and before each


@dataclass(frozen=True, eq=False)
class Triangulation:
    """Delaunay triangulation of a domain, constrained by its walls.

    Vertices on the walls come first, in their order along the walls.
    """

    domain: Domain
    points: Floats  # (n, 2) vertices, in the domain's unit
    triangles: Indices  # (t, 3) vertex at each corner, counter-clockwise
    loop: Indices  # (b,) loops of the first b vertices, which are those on the walls
    arc: Floats  # (b,) their arc lengths, ascending in each loop
    neighbours: Indices  # (t, 3) triangle across each edge, -1 at walls
    neighbour_edge: Indices  # (t, 3) number of that edge in the neighbour, -1 at walls

    @property
    def size(self) -> int:
        """Number of vertices, n."""
        return len(self.points)

    @property
    def arrays(self) -> tuple[Indices, Indices, Indices]:
        """The arrays `triangles`, `neighbours` and `neighbour_edge`, for compiled functions."""
        return self.triangles, self.neighbours, self.neighbour_edge

    @cached_property
    def fans(self) -> tuple[Indices, Indices]:
        """The triangle corners at each vertex, as two arrays.

        The second (3 t,) lists all triangle corners by vertex. The first (n + 1,) has the index in this list
        at which the corners of each vertex start.
        """
        start, corners, reached = surface_fans(self.arrays, self.size)
        if reached != len(corners):
            raise SolverError("triangles that meet in a point only")
        return start, corners

    @cached_property
    def edges(self) -> Complexes:
        """(t, 3) edges of each triangle as complex numbers; edge i begins at corner i."""
        z = complex_of(self.points[self.triangles])
        return np.asarray(z[:, NEXT] - z)

    @cached_property
    def areas(self) -> Floats:
        """(t,) areas of the triangles."""
        return np.asarray(0.5 * times(np.conj(self.edges[:, 0]), -self.edges[:, 2]).imag)

    @cached_property
    def angles(self) -> Floats:
        """(t, 3) angles at the corners, in radians."""
        return np.asarray(angle(-self.edges[:, PREVIOUS] / self.edges))

    @cached_property
    def gradients(self) -> Complexes:
        """Gradients (t, 3) of linear functions that are 1 at one corner of a triangle and 0 at the others."""
        return np.asarray(times(1j, self.edges[:, NEXT]) / (2.0 * self.areas[:, None]))

    @cached_property
    def walls(self) -> tuple[Indices, Indices]:
        """For each of w edges on walls, its triangle (w,) and its index (w,), 0 to 2, in this triangle."""
        triangles, edges = np.nonzero(self.neighbours < 0)
        return triangles, edges

    @cached_property
    def on_wall(self) -> Bools:
        """(n,) mask of vertices on walls."""
        flags = np.zeros(self.size, dtype=bool)
        flags[self.triangles[self.walls]] = True
        return flags

    @cached_property
    def edge_weights(self) -> Floats:
        """(t, 3) the cotangent of the angle opposite to each edge, times -1/2.

        This equals the integral over the triangle of the product of both end points' `gradients`.
        """
        g = self.gradients
        return np.asarray(self.areas[:, None] * times(g, np.conj(g[:, NEXT])).real)

    @cached_property
    def masses(self) -> Floats:
        """One third of the total area of the triangles around each vertex (n,)."""
        return self.gather(np.repeat(self.areas[:, None] / 3.0, 3, axis=1))

    @cached_property
    def euler(self) -> int:
        """Euler characteristic: 1 for a disc, 0 for an annulus."""
        inner = int((self.neighbours >= 0).sum()) // 2
        return self.size - inner - len(self.walls[0]) + len(self.triangles)

    def gather(self, corners: Floats) -> Floats:
        """Return for each vertex the sum (n,) of values `corners` (t, 3), given at corners of triangles."""
        return np.asarray(np.bincount(self.triangles.ravel(), corners.ravel(), self.size))

    def edge_size(self, vertices: Indices) -> Floats:
        """Return, for each of the `vertices`, the mean length of the edges that meet there."""
        lengths = self.gather(modulus(self.edges))
        return np.asarray(lengths[vertices] / np.diff(self.fans[0])[vertices])


def split_edges_between_walls(triangulation: Triangulation) -> Triangulation:
    """Return the triangulation with a new vertex on every interior edge that joins two wall vertices."""
    boundary = len(triangulation.arc)
    while True:
        triangles, neighbours = triangulation.triangles, triangulation.neighbours
        on_wall = triangles < boundary
        triangle, edge = np.nonzero(
            on_wall & on_wall[:, NEXT] & (neighbours > np.arange(len(triangles))[:, None])
        )
        if not len(triangle):
            return triangulation
        neighbour = neighbours[triangle, edge]
        # one edge of a triangle at a time
        least = np.full(len(triangles), len(triangle))
        number = np.arange(len(triangle))
        np.minimum.at(least, triangle, number)
        np.minimum.at(least, neighbour, number)
        now = (least[triangle] == number) & (least[neighbour] == number)
        triangulation = _split(triangulation, triangle[now], edge[now])


def _split(triangulation: Triangulation, triangle: Indices, edge: Indices) -> Triangulation:
    """Return the triangulation with the given edges split; no two of them are in one triangle."""
    triangles, points = triangulation.triangles, triangulation.points
    neighbour = triangulation.neighbours[triangle, edge]
    back = triangulation.neighbour_edge[triangle, edge]
    start, stop = triangles[triangle, edge], triangles[triangle, NEXT[edge]]
    left, right = triangles[triangle, PREVIOUS[edge]], triangles[neighbour, PREVIOUS[back]]
    middle = len(points) + np.arange(len(triangle))
    new = triangles.copy()
    new[triangle] = np.stack([start, middle, left], axis=1)
    new[neighbour] = np.stack([stop, middle, right], axis=1)
    halves = [np.stack([middle, stop, left], axis=1), np.stack([middle, start, right], axis=1)]
    new = np.concatenate([new, *halves])
    neighbours, neighbour_edge = join_triangles(new)
    return replace(
        triangulation,
        points=np.concatenate([points, 0.5 * (points[start] + points[stop])]),
        triangles=new,
        neighbours=neighbours,
        neighbour_edge=neighbour_edge,
    )


def join_triangles(triangles: Indices) -> tuple[Indices, Indices]:
    """Return (t, 3) the triangle beyond each edge, and the edge's index in that triangle; -1 if none."""
    start, stop = triangles.ravel(), triangles[:, NEXT].ravel()
    size = int(triangles.max()) + 1
    key, mate = start * size + stop, stop * size + start
    order = np.argsort(key, kind="stable")
    place = np.minimum(np.searchsorted(key, mate, sorter=order), len(key) - 1)
    half = np.where(key[order[place]] == mate, order[place], -1).reshape(-1, 3)
    return np.where(half < 0, -1, half // 3), np.where(half < 0, -1, half % 3)
