"""A map of a triangulated domain whose coordinate lines follow the cross field and the walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.decomposition.field.cross_field import CrossField, cross_field
from meshonet.solvers.blocking.decomposition.field.frames import cut_frames, frame_sizes
from meshonet.solvers.blocking.decomposition.field.parametrisation import Parametrisation
from meshonet.solvers.blocking.decomposition.surface.split_edges import split_edges_between_walls
from meshonet.solvers.blocking.decomposition.surface.surface import TriangleSurface
from meshonet.solvers.blocking.decomposition.surface.triangulation import Triangulation, triangulate

_FINER = 0.35
"""Edge lengths at singularities relative to those of the first triangulation; without refinement, vertices
of five cells fold. With this value 22 domains have 431 blocks, with 0.7 they have 455, with 0.2 454.
"""
_STIFFENINGS = 12  # solutions at the most; folds that stay are left to another triangulation
_NEARLY_FOLDED, _SMALL = 1e-3, 0.2
"""Relative Jacobians below which the map is solved again, and below which triangles are made stiffer.

Values of 0.05 and 0.5 instead of 0.2 change the mean score of 22 domains by less than 0.01.
"""


@dataclass(frozen=True, eq=False)
class SeamlessMap:
    r"""Coordinates w = u + i v at each corner of each triangle, continuous up to quarter turns and shifts.

    The coordinates of neighbours f and g agree along their common edge up to

        w_g = i^k (w_f - w_f(a)) + w_g(a),   k = turns[f, e], e the edge in f, a one of its ends,

    so that lines of constant u or v continue over every edge; if k is odd, u lines become v lines. Each edge
    of a wall is on such a line. Edge e of a triangle goes from its corner e to corner (e + 1) % 3::

               2
              / \
        e=2  /   \  e=1
            /     \
           0-------1
              e=0
    """

    surface: TriangleSurface
    corner_coords: Complexes
    """(t, 3) coordinates w, in the domain's unit of length times `sizes`, whose median is 1."""
    turns: Indices
    """(t, 3) quarter turns k across each edge, 0 to 3; 0 at walls."""
    wall_axis: Indices
    """(t, 3) at walls the direction d, 0 to 3, of the edge in the map: w(e + 1) - w(e) is i^d times a
    positive length; -1 at all other edges.
    """
    boundary_cells: Indices
    """(b,) number of cells at each boundary vertex: 2 except at corners, and at singularities on a wall.
    The angle in the map is 90 degrees times this.
    """
    corner_cells: Indices
    """(b,) intended number of cells at vertices that are corners of the domain, 1 to 4; 0 at others."""
    valence: Indices
    """(n,) number of cells at each interior vertex: 4 except at singularities; 0 for boundary vertices."""
    sizes: Floats
    """(t,) target length of the gradients of u and v in each triangle, e^H."""
    jacobians: Floats
    """(t,) determinant of the map's derivative divided by `sizes` squared: 1 is the target, 0 or less is
    folded.
    """

    @property
    def triangulation(self) -> Triangulation:
        """The triangles."""
        return self.surface.triangulation

    def fan(self, vertex: int) -> Indices:
        """Return the corners around a vertex, counter-clockwise, as 3 times triangle plus corner.

        At a wall vertex they go from the edge that leaves along the wall to the one that arrives.
        """
        start, corners = self.surface.fans
        return corners[start[vertex] : start[vertex + 1]]

    @property
    def folded(self) -> int:
        """Number of triangles with negative orientation; it must be 0 for tracing."""
        return int((self.jacobians <= 0.0).sum())

    @property
    def singular(self) -> Indices:
        """Interior vertices at which other than four cells meet, ascending."""
        return np.flatnonzero((self.valence != 4) & (self.valence > 0))


def seamless_map(domain: Domain, count: int = 1500, seed: int = 0, fewer: bool = True) -> SeamlessMap:
    """Return a seamless map of a domain that is triangulated with about `count` vertices.

    If the field has interior singularities, the domain is triangulated again with smaller triangles there. A
    map that is nearly folded is solved again with larger weights at these triangles; `SeamlessMap.folded`
    tells whether this succeeded. With `fewer`, the number of singularities is reduced.

    Raises SolverError: the field or the map has no solution; InputError: the domain cannot be triangulated.
    """
    surface = _surface(triangulate(domain, count, seed=seed))
    field = cross_field(surface, fewer)
    singular = field.singular
    if len(singular):
        points, sizes = surface.triangulation.points[singular], _FINER * surface.edge_size(singular)
        field = cross_field(_surface(triangulate(domain, count, finer=(points, sizes), seed=seed)), fewer)
    return map_of_field(field)


def _surface(triangulation: Triangulation) -> TriangleSurface:
    return TriangleSurface(split_edges_between_walls(triangulation))


def map_of_field(field: CrossField) -> SeamlessMap:
    """Return the seamless map that follows a cross field."""
    surface = field.surface
    frames, sizes = cut_frames(field), frame_sizes(field)
    system = Parametrisation(frames, sizes)
    coords = _unfolded(system)
    wall_axis = np.full(surface.vertices.shape, -1, dtype=np.intp)
    wall_axis[surface.walls] = frames.wall_axis
    return SeamlessMap(
        surface=surface,
        corner_coords=coords,
        turns=frames.turns,
        wall_axis=wall_axis,
        boundary_cells=field.boundary_cells[: len(surface.triangulation.arc)],
        corner_cells=field.walls.corner_cells,
        valence=field.valence,
        sizes=sizes,
        jacobians=system.jacobians(coords),
    )


def _unfolded(system: Parametrisation) -> Complexes:
    """Return coordinates (t, 3), stiffer where triangles come out small or folded (Bommes et al. 2009)."""
    weights = np.ones(len(system.sizes))
    coords = system.solve(weights)
    for _ in range(_STIFFENINGS):
        jacobians = system.jacobians(coords)
        if jacobians.min() > _NEARLY_FOLDED:
            break
        weights[jacobians < _SMALL] *= 2.0
        coords = system.solve(weights)
    return coords
