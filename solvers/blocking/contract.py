"""Edges of a quad mesh contracted, where a conforming mesh of the same domain is left.

Nodes that become one are where the corner among them is, else on the wall in the middle, else at their mean.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, distinct
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.kernels._native import joined_classes
from meshonet.solvers.blocking.padding import wrong_count

VALENCES = (3, 5)
"""Fewest and most quads around a node inside."""


def contract(mesh: QuadMesh, rungs: NDArray[np.bool_]) -> QuadMesh | None:
    """Return the mesh with the nodes of each edge in `rungs` (e,) made one; None where it would be invalid.

    That is where two corners would become one, wall nodes that no wall edges in `rungs` join, where more wall
    nodes than before have a wrong count of quads, or where what is left is no conforming mesh of the same
    domain with 3 to 5 quads around each node inside.
    """
    label, count = joined_classes(np.ascontiguousarray(mesh.edges[rungs]), len(mesh.nodes))
    kept = ~rungs[mesh.edge_of].any(axis=1)
    if not kept.any() or not _may_join(mesh, label, count, rungs):
        return None
    places = Places.inside(count)
    wall, corners = np.flatnonzero(mesh.places.loop >= 0), np.flatnonzero(mesh.places.cells > 0)
    places.loop[label[wall]] = mesh.places.loop[wall]
    places.cells[label[corners]] = mesh.places.cells[corners]
    double = np.flatnonzero(mesh.places.partner >= 0)
    places.partner[label[double]] = label[mesh.places.partner[double]]
    trial = QuadMesh(mesh.domain, np.zeros((count, 2)), label[mesh.quads[kept]], places)
    more = np.count_nonzero(wrong_count(trial)) > np.count_nonzero(wrong_count(mesh))
    return _placed(trial, mesh, label) if not more and is_conforming(trial) else None


def _may_join(mesh: QuadMesh, label: Indices, count: int, rungs: NDArray[np.bool_]) -> bool:
    """Return whether no class of nodes has two corners, and wall nodes in one are joined along the wall."""
    corners, wall = np.flatnonzero(mesh.places.cells > 0), np.flatnonzero(mesh.places.loop >= 0)
    if len(distinct(label[corners])) < len(corners):
        return False
    of_wall = np.bincount(label[wall], minlength=count)
    walls = rungs & mesh.on_wall & (mesh.places.loop[mesh.edges] >= 0).all(axis=1)
    links = np.bincount(label[mesh.edges[walls, 0]], minlength=count)
    return not ((of_wall > 1) & (links != of_wall - 1)).any()


def _placed(trial: QuadMesh, mesh: QuadMesh, label: Indices) -> QuadMesh:
    """Put the nodes of `trial`, classes of those of `mesh`, at their places."""
    places, count = mesh.places, len(trial.nodes)
    corners, wall = np.flatnonzero(places.cells > 0), np.flatnonzero(places.loop >= 0)
    of, loop, cells = label[wall], trial.places.loop, trial.places.cells
    members = np.bincount(of, minlength=count)
    first, arc = np.zeros(count), np.zeros(count)
    first[of[::-1]] = places.arc[wall[::-1]]
    lengths = np.array([loop.length for loop in mesh.domain.loops])
    length = lengths[places.loop[wall]]
    off = np.mod(places.arc[wall] - first[of] + 0.5 * length, length) - 0.5 * length
    mean = first + np.bincount(of, off, minlength=count) / np.maximum(members, 1)
    arc[of] = np.mod(mean[of], length)
    nodes = _means(trial, mesh, label)
    nodes[of] = mesh.nodes[wall]
    merged = np.flatnonzero(members > 1)
    for number in distinct(loop[merged]):
        moved = merged[loop[merged] == number]
        nodes[moved] = mesh.domain.loops[number].at(arc[moved])
    arc[label[corners]], nodes[label[corners]] = places.arc[corners], mesh.nodes[corners]
    return trial.with_places(nodes, Places(loop, arc, cells, trial.places.partner))


def _means(trial: QuadMesh, mesh: QuadMesh, label: Indices) -> Floats:
    """Return the means (count, 2) of nodes that are one; with partners, those of both sides count."""
    own, nodes = label, mesh.nodes
    partner, period = trial.places.partner, mesh.domain.periodic
    moved = np.flatnonzero(partner >= 0)
    shift = np.array(period.shift if period else (0.0, 0.0))
    if moved.size:
        stands = np.arange(len(partner))
        stands[moved] = partner[moved]
        own = stands[label]
        nodes = nodes - np.where((own != label)[:, None], shift, 0.0)
    size = np.maximum(np.bincount(own, minlength=len(partner)), 1)
    means = np.stack([np.bincount(own, axis, minlength=len(partner)) / size for axis in nodes.T], axis=1)
    means[moved] = means[partner[moved]] + shift
    return means


def is_conforming(mesh: QuadMesh) -> bool:
    """Return whether the quads are a mesh of the domain: manifold, holes kept, wall nodes on walls.

    Nodes inside have as many quads as `VALENCES` allow.
    """
    closed, single = mesh.closed, mesh.places.partner < 0
    quads, n = closed.quads, int(np.count_nonzero(single))
    rounds = 0 if closed is mesh else 1  # what is joined along a line has one less
    if not closed.manifold or n - len(closed.edges) + len(quads) != 2 - len(mesh.domain.loops) - rounds:
        return False
    repeated = [(quads == np.roll(quads, k, axis=1)).any() for k in (1, 2)]
    wall = closed.wall_nodes
    if any(repeated) or not np.array_equal(wall[single], mesh.places.loop[single] >= 0):
        return False
    around = np.bincount(closed.edges[closed.on_wall].ravel(), minlength=len(wall))
    inside = closed.valence[~wall & single]
    fits = not inside.size or (inside.min() >= VALENCES[0] and inside.max() <= VALENCES[1])
    return bool((around[wall] == 2).all() and fits)
