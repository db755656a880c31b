"""A map of a triangulated domain whose coordinate lines follow the cross field and the walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.polygon.corners import Indices

if TYPE_CHECKING:
    from meshonet.solvers.blocking.triangulation import Triangulation


@dataclass(frozen=True, eq=False)
class SeamlessMap:
    r"""Coordinates w = u + i v at each corner of each triangle, continuous but for quarter-turns and shifts.

    The coordinates of neighbours f and g agree along their edge up to

        w_g = i^k (w_f - w_f(a)) + w_g(a),   k = turns[f, e], e the edge in f, a one of its ends,

    so lines of constant u or v go on over every edge, u lines as v lines where k is odd. Each edge of a wall
    lies on such a line. Edge e of a triangle goes from its corner e to corner (e + 1) % 3::

               2
              / \
        e=2  /   \  e=1
            /     \
           0-------1
              e=0
    """

    triangulation: Triangulation
    vertices: Indices
    """(t, 3) vertex at each corner of each triangle, counter-clockwise. It is `triangulation.triangles`, but
    in a periodic domain a vertex of the second stretch has the number of its partner on the first."""
    neighbours: Indices
    """(t, 3) triangle across each edge, -1 at walls; across a period too."""
    neighbour_edge: Indices
    """(t, 3) number of that edge in the neighbour, -1 at walls."""
    periods: Indices
    """(t, 3) how often the period's shift is to be added to points of a triangle when an edge is crossed,
    to have them beside the neighbour: 0, or 1 or -1 across a period."""
    corner_coords: Complexes
    """(t, 3) coordinates w. The unit is the domain's length times a local factor e^H, whose median is 1;
    Jacobians are positive if `folded` is 0."""
    turns: Indices
    """(t, 3) quarter-turns k across each edge, 0 to 3; 0 at walls."""
    wall_axis: Indices
    """(t, 3) at walls the direction d, 0 to 3, of the edge in the map: w(e + 1) - w(e) is i^d times a
    positive length; -1 at all other edges."""
    on_wall: NDArray[np.bool_]
    """(n,) the vertex lies on a wall."""
    boundary_cells: Indices
    """(b,) cells that the field has meet at each boundary vertex: 2 but for corners, and but for places where
    a singularity sits on a wall. The angle in the map is 90 degrees times this. 0 for vertices that are no
    walls' (periodic stretches)."""
    corner_cells: Indices
    """(b,) cells that are wanted at vertices which are corners of the domain, 1 to 4; 0 for all others."""
    valence: Indices
    """(n,) cells that meet at each inner vertex: 4 but for singularities; 0 for boundary vertices, see
    `boundary_cells`."""
    fan_start: Indices
    """(n + 1,) where the corners around each vertex start in `fan_corners`."""
    fan_corners: Indices
    """(3 t,) corners around each vertex, counter-clockwise, as 3 times the triangle plus the corner in it;
    at a wall's vertex from the edge that leaves along the wall to the one that arrives."""
    size: Floats
    """(t,) target length of the gradients of u and v in each triangle, e^H."""

    def fan(self, vertex: int) -> Indices:
        """Return the corners around a vertex, counter-clockwise, as 3 times triangle plus corner."""
        return self.fan_corners[self.fan_start[vertex] : self.fan_start[vertex + 1]]

    @property
    def singular(self) -> Indices:
        """Inner vertices where other than four cells meet, ascending."""
        return np.flatnonzero((self.valence != 4) & ~self.on_wall & (self.valence > 0))
