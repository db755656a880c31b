"""Directions of the cross field along walls, turned near corners so that a whole number of cells meets there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.surface import NEXT, Surface

QUARTER = 0.5 * np.pi
_REACH = 0.15
"""How far a corner turns the field, as part of its loop; at most half the way to the next corner."""


@dataclass(frozen=True, eq=False)
class WallDirections:
    """Angles along walls as the field is to have them."""

    corner_cells: Indices
    """(b,) cells wanted at boundary vertices that are corners, 0 at all others."""
    vertices: Floats
    """(n,) angle at each wall vertex, 0 at all others."""
    edges: Floats
    """(w,) angle of each wall edge, in the order of `Surface.walls`."""
    offsets: Floats
    """(w,) by how much that differs from the edge's own angle."""
    inside: Floats
    """(n,) angle between the two walls of a wall vertex."""


def wall_directions(surface: Surface) -> WallDirections:
    """Return directions along the walls of a surface.

    At a corner of angle alpha where k cells are to meet, either wall is taken to be turned by half of
    k 90 degrees - alpha, less and less away from it: the cross at the corner is then the same for both, and the
    valence there is a boundary condition. Elsewhere the direction is the mean of both edges.
    """
    triangle, edge = surface.walls
    start, stop = surface.vertices[triangle, edge], surface.vertices[triangle, NEXT[edge]]
    own = np.angle(surface.edges[triangle, edge])
    inside = surface.gather(surface.angles)
    cells, after, before = _corner_offsets(surface, inside)
    places = surface.triangulation.triangles
    leaving, arriving = after[places[triangle, edge]], before[places[triangle, NEXT[edge]]]
    angle = np.zeros(surface.size)
    angle[start] = own - 0.5 * (np.pi - inside[start])
    here = cells[places[triangle, edge]] > 0
    angle[start[here]] = own[here]
    angle[start] += leaving
    offsets = 0.5 * (leaving + arriving)
    return WallDirections(cells, angle, own + offsets, offsets, np.where(surface.on_wall, inside, 0.0))


def _corner_offsets(surface: Surface, inside: Floats) -> tuple[Indices, Floats, Floats]:
    """Return cells wanted (b,), and offsets (b,) of walls that leave vertices and of those that arrive."""
    triangulation = surface.triangulation
    count = len(triangulation.arc)
    cells = np.zeros(count, dtype=np.intp)
    after, before = np.zeros(count), np.zeros(count)
    for number, loop in enumerate(triangulation.domain.loops):
        if not loop.corners:
            continue
        mine = np.flatnonzero(triangulation.loop == number)
        away = _around(triangulation.arc[mine][:, None] - loop.corner_arcs, loop.length)
        at = mine[np.argmin(np.abs(away), axis=0)]
        cells[at] = loop.corner_cells
        half = 0.5 * (loop.corner_cells * QUARTER - inside[at])
        nearest = np.argmin(np.abs(away), axis=1)
        reach = _reaches(loop)[nearest]
        distance = np.take_along_axis(away, nearest[:, None], axis=1)[:, 0]
        offset = half[nearest] * np.maximum(0.0, 1.0 - np.abs(distance) / reach) ** 2
        after[mine] = before[mine] = np.where(distance > 0, -offset, offset)
        after[at], before[at] = -half, half
    return cells, after, before


def _reaches(loop: Loop) -> Floats:
    steps = np.diff(loop.corner_arcs, append=loop.corner_arcs[0] + loop.length)
    return np.minimum(0.5 * np.minimum(steps, np.roll(steps, 1)), _REACH * loop.length)


def _around(length: Floats, whole: float) -> Floats:
    return np.asarray(length - whole * np.round(length / whole))
