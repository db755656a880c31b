"""First cells of layers with the heights that they had, before what is beyond them is optimised once more.

::

    wall |--o----o------o---------o      a node of the first row is moved along the line that leaves the wall
         |-o-----o------o---------o      to its old height, and held there
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.smoothing.spacing import thin_heights


def with_first_cells(mesh: QuadMesh, given: QuadMesh) -> tuple[QuadMesh, NDArray[np.bool_]]:
    """Return `mesh` with the heights of thin first cells that `given`, the same quads, has, and which nodes.

    Those (n,) are the nodes at both ends of these heights. Where wall nodes slid, the height is that at the
    same arc length. First nodes beside two walls stay where they are.
    """
    wall, inner = _first_edges(given)
    height = np.log(np.hypot(*(given.nodes[inner] - given.nodes[wall]).T))
    for number, loop in enumerate(given.domain.loops):
        on = np.flatnonzero(given.places.loop[wall] == number)
        if not len(on):
            continue
        old, new = (each.places.arc[wall[on]] for each in (given, mesh))
        moved = old != new
        if moved.any():
            height[on[moved]] = np.interp(new[moved], old, height[on], period=loop.length)
    nodes, held = mesh.nodes.copy(), np.zeros(len(mesh.nodes), dtype=bool)
    way = nodes[inner] - nodes[wall]
    nodes[inner] = nodes[wall] + way * (np.exp(height) / np.hypot(*way.T))[:, None]
    held[wall] = held[inner] = True
    return mesh.with_nodes(nodes), held


def _first_edges(mesh: QuadMesh) -> tuple[Indices, Indices]:
    """Return the wall node and the inner node of edges that are heights of thin first cells, of one wall."""
    ends = mesh.edges[thin_heights(mesh)]
    first = mesh.wall_nodes[ends[:, 0]]
    wall, inner = np.where(first, ends[:, 0], ends[:, 1]), np.where(first, ends[:, 1], ends[:, 0])
    once = np.bincount(inner, minlength=len(mesh.nodes))[inner] == 1
    return wall[once], inner[once]
