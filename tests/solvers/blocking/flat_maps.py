"""Seamless maps that are known: of right-angled domains, annuli and cones, over random triangulations."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from scipy.spatial import Delaunay

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.solvers.blocking.decomposition.field.seamless_map import SeamlessMap
from meshonet.solvers.blocking.decomposition.surface.surface import Triangulation


def seamless_of(
    domain: Domain,
    coordinates: Callable[[Complexes, Complexes], Complexes],
    *,
    count: int = 1500,
    seed: int = 0,
    centre: bool = False,
) -> SeamlessMap:
    """Return the map whose coordinates at corners z (t, 3) of triangles of centres (t, 1) are given.

    With `centre` the origin is a vertex.
    """
    triangulation = triangulated(domain, count, seed, centre=centre)
    triangles, points = triangulation.triangles, triangulation.points
    z = points[:, 0] + 1j * points[:, 1]
    w = coordinates(z[triangles], z[triangles].mean(axis=1, keepdims=True))
    near, edge = triangulation.neighbours, triangulation.neighbour_edge
    turns = np.zeros_like(near)
    for f, e in np.ndindex(near.shape):
        step = w[f, (e + 1) % 3] - w[f, e]
        if near[f, e] >= 0:
            other = w[near[f, e], edge[f, e]] - w[near[f, e], (edge[f, e] + 1) % 3]
            turns[f, e] = round(np.angle(other / step) / (np.pi / 2)) % 4
    inside = np.angle((np.roll(w, 1, axis=1) - w) / (np.roll(w, -1, axis=1) - w))
    around = np.round(np.bincount(triangles.ravel(), inside.ravel()) / (np.pi / 2)).astype(np.intp)
    walls = len(triangulation.loop)
    corner_cells = np.zeros(walls, dtype=np.intp)
    for number, loop in enumerate(domain.loops):
        for arc, cells in zip(loop.corner_arcs, loop.corner_cells, strict=True):
            own = np.flatnonzero(triangulation.loop == number)
            corner_cells[own[np.argmin(np.abs(triangulation.arc[own] - arc))]] = cells
    on_wall = np.arange(len(points)) < walls
    return SeamlessMap(
        surface=triangulation,
        corner_coords=np.ascontiguousarray(w),
        turns=turns,
        boundary_cells=around[:walls],
        corner_cells=corner_cells,
        valence=np.where(on_wall, 0, around),
    )


def triangulated(domain: Domain, count: int, seed: int, *, centre: bool) -> Triangulation:
    """Return a Delaunay triangulation of about so many random points, corners among them."""
    rng = np.random.default_rng(seed)
    size = np.sqrt(domain.area / count)
    points, loops, arcs = [], [], []
    for number, loop in enumerate(domain.loops):
        ends = (
            np.append(loop.corner_arcs, loop.corner_arcs[0] + loop.length)
            if loop.corners
            else [0, loop.length]
        )
        for a, b in pairwise(ends):
            steps = max(3, int(np.ceil((b - a) / size)))
            inner = (np.arange(1, steps) + rng.uniform(-0.2, 0.2, steps - 1)) / steps
            arc = a + (b - a) * np.append(0.0, inner)
            points.append(loop.at(arc))
            loops += [number] * steps
            arcs += np.mod(arc, loop.length).tolist()
    wall = np.concatenate(points)
    rings = [wall[np.array(loops) == number] for number in range(len(domain.loops))]
    region = shapely.Polygon(rings[0], rings[1:])
    low, high = wall.min(axis=0), wall.max(axis=0)
    nx, ny = np.ceil((high - low) / size).astype(int)
    grid = np.stack(np.meshgrid(np.arange(nx) + 0.5, np.arange(ny) + 0.5), axis=-1).reshape(-1, 2)
    free = low + size * (grid + rng.uniform(-0.3, 0.3, grid.shape))
    inner = region.buffer(-0.5 * size)
    free = free[shapely.contains_xy(inner, free[:, 0], free[:, 1])]
    if centre:
        free[np.argmin(np.hypot(*free.T))] = 0.0
    every = np.concatenate([wall, free])
    triangles = Delaunay(every).simplices
    middle = every[triangles].mean(axis=1)
    triangles = triangles[shapely.contains_xy(region, middle[:, 0], middle[:, 1])].astype(np.intp)
    x = every[triangles]
    left = _area(x)
    triangles[left < 0] = triangles[left < 0][:, ::-1]
    near, edge = _neighbours(triangles)
    return Triangulation(
        domain=domain,
        points=every,
        triangles=triangles,
        loop=np.array(loops, dtype=np.intp),
        arc=np.array(arcs),
        neighbours=near,
        neighbour_edge=edge,
    )


def _area(x: Floats) -> Floats:
    a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _neighbours(triangles: Any) -> tuple[Any, Any]:
    near, edge = np.full(triangles.shape, -1, dtype=np.intp), np.full(triangles.shape, -1, dtype=np.intp)
    at = {(int(t[e]), int(t[(e + 1) % 3])): (f, e) for f, t in enumerate(triangles) for e in range(3)}
    for (a, b), (f, e) in at.items():
        if (b, a) in at:
            near[f, e], edge[f, e] = at[b, a]
    return near, edge


def flat(z: Complexes, centre: Complexes) -> Complexes:
    """Return the coordinates of the plane itself: the map of a right-angled domain."""
    return z + 0 * centre


def logarithm(z: Complexes, centre: Complexes) -> Complexes:
    """Return the map of an annulus around the origin."""
    return np.log(z / centre) + np.log(centre)


def cone(valence: int) -> Callable[[Complexes, Complexes], Complexes]:
    """Return the map in which so many right angles meet at the origin: z to the power of valence / 4."""

    def power(z: Complexes, centre: Complexes) -> Complexes:
        ratio = np.where(np.abs(z) > 1e-12, z / centre, 0)
        p = valence / 4
        return np.where(ratio == 0, 0, np.abs(z) ** p * np.exp(1j * p * (np.angle(ratio) + np.angle(centre))))

    return power
