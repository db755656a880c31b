"""Splits interior edges between two walls, which leave a map no freedom."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.solvers.blocking.decomposition.surface.surface import NEXT, PREVIOUS, Triangulation


def split_edges_between_walls(triangulation: Triangulation) -> Triangulation:
    """Return the triangulation with a new vertex on every interior edge that joins two wall vertices.

    Otherwise a triangle with two edges on the same wall would have all its vertices on one line of the map,
    and a gap one triangle wide could not contain a singularity.
    """
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
    """Return the triangle (t, 3) across each edge, and the index (0 to 2) of the edge in that triangle.

    Both are -1 at walls.
    """
    start, stop = triangles.ravel(), triangles[:, NEXT].ravel()
    size = int(triangles.max()) + 1
    key, mate = start * size + stop, stop * size + start
    order = np.argsort(key, kind="stable")
    place = np.minimum(np.searchsorted(key, mate, sorter=order), len(key) - 1)
    half = np.where(key[order[place]] == mate, order[place], -1).reshape(-1, 3)
    return np.where(half < 0, -1, half // 3), np.where(half < 0, -1, half % 3)
