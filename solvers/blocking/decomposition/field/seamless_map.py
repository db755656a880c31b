"""A map of a triangulated domain whose coordinate lines follow the cross field and the walls."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes, Indices
from meshonet.geometry.domain.domain import Domain
from meshonet.solvers.blocking.decomposition.field.cross_field import cross_field
from meshonet.solvers.blocking.decomposition.field.frames import cut_frames, frame_sizes
from meshonet.solvers.blocking.decomposition.field.parametrisation import Parametrisation
from meshonet.solvers.blocking.decomposition.surface.surface import Triangulation, split_edges_between_walls
from meshonet.solvers.blocking.decomposition.surface.triangulation import triangulate

_FINER = 0.35
"""Edge lengths at singularities over those of the first triangulation; 0.7 and 0.2 give more blocks."""
_STIFFENINGS = 12  # largest number of solutions; if folds remain, another triangulation is tried
_NEARLY_FOLDED, _SMALL = 1e-3, 0.2
"""Relative Jacobians below which the map is solved again, and below which triangles are made stiffer."""


@dataclass(frozen=True, eq=False)
class SeamlessMap:
    r"""Coordinates w = u + i v at each corner of each triangle, continuous up to quarter turns and shifts.

    Let triangles f and g have a common edge, which is edge e of f and begins at the point a. On this edge

        w_g = i^k (w_f - w_f(a)) + w_g(a),   k = turns[f, e]

    Hence lines of constant u or v continue across every edge; if k is odd, a u line continues as a v line.
    Each wall edge is part of such a line. Edge e of a triangle goes from its corner e to corner (e + 1) % 3::

               2
              / \
        e=2  /   \  e=1
            /     \
           0-------1
              e=0
    """

    surface: Triangulation
    corner_coords: Complexes
    """(t, 3) coordinates w, in the domain's unit of length times sizes of frames, whose median is 1."""
    turns: Indices  # (t, 3) quarter turns k across each edge, 0 to 3; 0 at walls
    boundary_cells: Indices
    """(b,) number of cells at each boundary vertex: 2 except at corners and singularities on a wall."""
    corner_cells: Indices
    """(b,) intended number of cells at vertices that are corners of the domain, 1 to 4; 0 at others."""
    valence: Indices
    """(n,) number of cells at each interior vertex: 4 except at singularities; 0 for boundary vertices."""

    @property
    def singular(self) -> Indices:
        """Indices of the interior vertices at which more or fewer than four cells meet, ascending."""
        return np.flatnonzero((self.valence != 4) & (self.valence > 0))


def seamless_map(domain: Domain, count: int = 1500, seed: int = 0, fewer: bool = True) -> SeamlessMap:
    """Return a map from a triangulated domain to coordinates u, v; walls are lines of constant u or v.

    There are about `count` vertices; the triangulation depends on `seed`. Some triangles may be folded in the
    map. If `fewer` is true, the number of singularities is reduced.

    Raises SolverError if there is no such map; InputError if triangulation is impossible.
    """
    surface = split_edges_between_walls(triangulate(domain, count, seed=seed))
    field = cross_field(surface, fewer)
    singular = field.singular
    if len(singular):
        finer = surface.points[singular], _FINER * surface.edge_size(singular)
        surface = split_edges_between_walls(triangulate(domain, count, finer=finer, seed=seed))
        field = cross_field(surface, fewer)
    frames = cut_frames(field)
    return SeamlessMap(
        surface=surface,
        corner_coords=_unfolded(Parametrisation(frames, frame_sizes(field))),
        turns=frames.turns,
        boundary_cells=field.boundary_cells[: len(surface.arc)],
        corner_cells=field.walls.corner_cells,
        valence=field.valence,
    )


def _unfolded(system: Parametrisation) -> Complexes:
    """Return coordinates (t, 3), with larger weights where triangles are small or folded (Bommes 2009)."""
    weights = np.ones(len(system.sizes))
    coords = system.solve(weights)
    for _ in range(_STIFFENINGS):
        jacobians = system.jacobians(coords)
        if jacobians.min() > _NEARLY_FOLDED:
            break
        weights[jacobians < _SMALL] *= 2.0
        coords = system.solve(weights)
    return coords
