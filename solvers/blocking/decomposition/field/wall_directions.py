"""Directions of the cross field along walls, rotated near corners so that a whole number of cells fits."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats, Indices
from meshonet.geometry.elementary import angle as angle_of
from meshonet.geometry.elementary import exp, tan, times
from meshonet.solvers.blocking.decomposition.surface.surface import NEXT, Triangulation

QUARTER = 0.5 * np.pi  # symmetry of the field, radians
_REACH = 0.15
"""Distance over which a corner rotates the field, over the length of its loop; at most half a side."""


@dataclass(frozen=True, eq=False)
class WallDirections:
    """Prescribed angles of the cross field along walls."""

    corner_cells: Indices  # (b,) number of cells at boundary vertices that are corners, 0 at others
    vertices: Floats  # (n,) angle at each wall vertex, 0 at all others
    shears: Complexes
    """(n,) near acute corners, nu of the linear map z - nu conj(z) that rotates the walls to these angles."""
    edges: Floats  # (w,) angle of each wall edge, in the order of `Triangulation.walls`
    offsets: Floats  # (w,) difference from the edge's own angle
    inside: Floats  # (n,) angle between the two walls of a wall vertex


def wall_directions(surface: Triangulation) -> WallDirections:
    """Return the directions that the cross field should have along the walls of a surface.

    At a corner where k cells meet, the directions of the two walls are rotated by equal angles, in opposite
    senses, until there are 90 k degrees between them. The rotation decreases along the walls with the
    distance from the corner. It is added to the direction of each wall edge. At a wall vertex that is no
    corner, it is added to the mean direction of the two wall edges.
    """
    triangle, edge = surface.walls
    start = surface.triangles[triangle, edge]
    own = angle_of(surface.edges[triangle, edge])
    inside = surface.gather(surface.angles)
    cells, after, before, acute = _corner_offsets(surface, np.where(surface.on_wall, inside, 0.0))
    leaving, arriving = after[start], before[surface.triangles[triangle, NEXT[edge]]]
    angle = np.zeros(surface.size)
    angle[start] = own - 0.5 * (np.pi - inside[start])
    here = cells[start] > 0
    angle[start[here]] = own[here]
    angle[start] += leaving
    shears = np.zeros(surface.size, dtype=np.complex128)
    sheared = np.where(acute[start], tan(leaving), 0.0)
    shears[start] = times(-1j * sheared, exp(2j * angle[start]))
    offsets = 0.5 * (leaving + arriving)
    inside = np.where(surface.on_wall, inside, 0.0)
    return WallDirections(cells, angle, shears, own + offsets, offsets, inside)


def _corner_offsets(surface: Triangulation, inside: Floats) -> tuple[Indices, Floats, Floats, Bools]:
    """Return cells (b,), offsets (b,) of the walls after and before, and whether (b,) the corner is acute."""
    count = len(surface.arc)
    cells = np.zeros(count, dtype=np.intp)
    after, before, acute = np.zeros(count), np.zeros(count), np.zeros(count, dtype=bool)
    for number, loop in enumerate(surface.domain.loops):
        if not loop.corners:
            continue
        mine = np.flatnonzero(surface.loop == number)
        arcs = surface.arc[mine]
        at = mine[_nearest(loop.corner_arcs, arcs, loop.length)]
        wanted = loop.corner_cells
        cells[at] = wanted
        half = 0.5 * (wanted * QUARTER - inside[at])
        nearest = _nearest(arcs, loop.corner_arcs, loop.length)
        _, lengths = loop.pieces
        reaches = np.minimum(0.5 * np.minimum(lengths, np.roll(lengths, 1)), _REACH * loop.length)
        reach, distance = reaches[nearest], _around(arcs - loop.corner_arcs[nearest], loop.length)
        acute[mine] = ((wanted == 1) & (half > 0))[nearest]
        offset = half[nearest] * np.maximum(0.0, 1.0 - np.abs(distance) / reach) ** 2
        after[mine] = before[mine] = np.where(distance > 0, -offset, offset)
        after[at], before[at] = -half, half
    return cells, after, before, acute


def _nearest(arcs: Floats, places: Floats, length: float) -> Indices:
    """Return the index (m,) of the nearest of ascending `places` around a loop for each arc length (m,)."""
    after = np.searchsorted(places, arcs)
    before, after = (after - 1) % len(places), after % len(places)
    nearer = np.abs(_around(arcs - places[before], length)) <= np.abs(_around(arcs - places[after], length))
    return np.where(nearer, before, after)


def _around(length: Floats, whole: float) -> Floats:
    return np.asarray(length - whole * np.round(length / whole))
