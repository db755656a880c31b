"""Contracts edges of a quad mesh if the result is a conforming mesh of the same domain."""

import numpy as np

from meshonet.geometry.arrays import Bools, Indices, distinct, shortest_ways
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.kernels._native import joined_classes
from meshonet.solvers.blocking.decomposition.quads.padding import wrong_count
from meshonet.solvers.blocking.decomposition.quads.quad_mesh import conforms

VALENCES = (3, 5)
"""Smallest and largest number of quads around an interior node."""


def contract(mesh: QuadMesh, rungs: Bools) -> QuadMesh | None:
    """Return the mesh with the nodes of each edge in `rungs` (e,) merged; None if it would be invalid.

    Merged nodes are moved to the corner among them, else to the mean of their arc lengths on the wall, else
    to their mean. The mesh would be invalid if two corners were merged; if wall nodes were merged that no
    wall edge in `rungs` connects; if more wall nodes than before had a wrong number of quads; or if it were
    not a conforming mesh of the same domain with 3 to 5 quads around each interior node.
    """
    label, count = joined_classes(np.ascontiguousarray(mesh.edges[rungs]), len(mesh.nodes))
    kept = ~rungs[mesh.edge_of].any(axis=1)
    if not kept.any() or not _may_join(mesh, label, count, rungs):
        return None
    places = Places.inside(count)
    wall, corners = np.flatnonzero(mesh.places.loop >= 0), np.flatnonzero(mesh.places.cells > 0)
    places.loop[label[wall]] = mesh.places.loop[wall]
    places.cells[label[corners]] = mesh.places.cells[corners]
    trial = QuadMesh(mesh.domain, np.zeros((count, 2)), label[mesh.quads[kept]], places)
    more = np.count_nonzero(wrong_count(trial)) > np.count_nonzero(wrong_count(mesh))
    return _placed(trial, mesh, label) if not more and is_conforming(trial) else None


def _may_join(mesh: QuadMesh, label: Indices, count: int, rungs: Bools) -> bool:
    """Return whether each class has at most one corner, and wall nodes only if the wall joins them."""
    corners, wall = np.flatnonzero(mesh.places.cells > 0), np.flatnonzero(mesh.places.loop >= 0)
    if len(distinct(label[corners])) < len(corners):
        return False
    of_wall = np.bincount(label[wall], minlength=count)
    walls = rungs & mesh.on_wall & (mesh.places.loop[mesh.edges] >= 0).all(axis=1)
    links = np.bincount(label[mesh.edges[walls, 0]], minlength=count)
    return not ((of_wall > 1) & (links != of_wall - 1)).any()


def _placed(trial: QuadMesh, mesh: QuadMesh, label: Indices) -> QuadMesh:
    """Return `trial` with its nodes, classes of those of `mesh`, in their places."""
    places, count = mesh.places, len(trial.nodes)
    corners, wall = np.flatnonzero(places.cells > 0), np.flatnonzero(places.loop >= 0)
    of, loop, cells = label[wall], trial.places.loop, trial.places.cells
    members = np.bincount(of, minlength=count)
    first, arc = np.zeros(count), np.zeros(count)
    first[of[::-1]] = places.arc[wall[::-1]]
    length = mesh.domain.lengths[places.loop[wall]]
    off = shortest_ways(places.arc[wall] - first[of], length)
    mean = first + np.bincount(of, off, minlength=count) / np.maximum(members, 1)
    arc[of] = np.mod(mean[of], length)
    size = np.bincount(label, minlength=count)
    nodes = np.stack([np.bincount(label, axis, minlength=count) / size for axis in mesh.nodes.T], axis=1)
    nodes[of] = mesh.nodes[wall]
    merged = np.flatnonzero(members > 1)
    nodes[merged] = mesh.domain.at(loop[merged], arc[merged])
    arc[label[corners]], nodes[label[corners]] = places.arc[corners], mesh.nodes[corners]
    return trial.with_places(nodes, Places(loop, arc, cells, trial.places.partner))


def is_conforming(mesh: QuadMesh, many: int = 0) -> bool:
    """Return whether the mesh conforms, with 3 to 5 (or up to `many`) quads around each interior node."""
    inside = mesh.valence[~mesh.wall_nodes]
    few, many = VALENCES[0], max(VALENCES[1], many)
    return conforms(mesh) and bool(((inside >= few) & (inside <= many)).all())
