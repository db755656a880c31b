"""A ring of quads along smooth loops where the field put singularities on the wall.

A loop without corners, a disc for instance, may carry nodes where more or fewer than two quads meet. With a
ring of quads along the loop they become irregular nodes inside, and every node on the wall regular.

Mitchell, Tautges, "Pillowing doublets: refining a mesh to ensure that faces share at most one edge", 4th
International Meshing Roundtable (1995).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import distinct
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices

INSET = 0.25
"""How far old wall nodes move inside, in lengths of the shorter edge beside them."""


def wrong_count(mesh: QuadMesh) -> NDArray[np.bool_]:
    """Return the boundary nodes (n,) where other than the wanted count of quads meet: 2 but at corners."""
    closed = mesh.closed
    cells = closed.places.cells
    return np.asarray(closed.wall_nodes & (closed.valence != np.where(cells > 0, cells, 2)))


def loops_to_pad(mesh: QuadMesh) -> list[int]:
    """Return the numbers of loops without corners on which some node has a wrong count of quads."""
    wrong = distinct(mesh.places.loop[wrong_count(mesh)])
    return [int(loop) for loop in wrong if loop >= 0 and not mesh.domain.loops[loop].corners]


def pad(mesh: QuadMesh, loops: list[int]) -> QuadMesh:
    """Return the mesh with a ring of quads along these loops; old wall nodes lie inside then.

    >>> from meshonet.geometry.domain.domain import Domain
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> places = Places(np.zeros(4, int), np.arange(4.0), np.zeros(4, int), np.full(4, -1))
    >>> one = QuadMesh(Domain.of_polygons([square]), square, np.array([[0, 1, 2, 3]]), places)
    >>> ring = pad(one, [0])
    >>> len(ring.quads), ring.valence.tolist()
    (5, [3, 3, 3, 3, 2, 2, 2, 2])
    """
    if not loops:
        return mesh
    along, ahead = _wall_edges(mesh, loops)
    n, k = len(mesh.nodes), len(along)
    copy = np.full(n, -1, dtype=np.intp)
    copy[along] = n + np.arange(k)
    ring = np.stack([copy[along], copy[ahead], ahead, along], axis=1)
    before = np.empty(n, dtype=np.intp)
    before[ahead] = along
    here, last, coming = mesh.nodes[along], mesh.nodes[before[along]], mesh.nodes[ahead]
    tangent = coming - last
    tangent /= np.hypot(*tangent.T)[:, None]
    left = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    shorter = np.minimum(np.hypot(*(here - last).T), np.hypot(*(coming - here).T))
    nodes = np.concatenate([mesh.nodes, here])
    nodes[along] += INSET * shorter[:, None] * left
    return QuadMesh(mesh.domain, nodes, np.concatenate([mesh.quads, ring]), _moved(mesh.places, along))


def _wall_edges(mesh: QuadMesh, loops: list[int]) -> tuple[Indices, Indices]:
    """Return where the edges on these loops begin and end, the domain on their left, by node."""
    on = mesh.on_wall[mesh.edge_of] & np.isin(mesh.places.loop[mesh.quads], loops)
    first, second = mesh.quads[on], np.roll(mesh.quads, -1, axis=1)[on]
    order = np.argsort(first)
    return first[order], second[order]


def _moved(places: Places, along: Indices) -> Places:
    """Return the places after those of the nodes `along` a loop went to copies behind all others."""
    loop, arc, cells, partner = places.loop, places.arc, places.cells, places.partner
    copies = (np.concatenate([values, values[along]]) for values in (loop, arc, cells, partner))
    loop, arc, cells, partner = copies
    loop[along], arc[along], cells[along], partner[along] = -1, 0.0, 0, -1
    cells[len(places.loop) :][cells[len(places.loop) :] > 0] = 2
    return Places(loop, arc, cells, partner)
