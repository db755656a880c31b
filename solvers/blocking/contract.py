"""Edges of a quad mesh contracted, where a conforming mesh of the same domain is left.

Nodes that become one are where the corner among them is, else on the wall in the middle, else at their mean.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.kernels._native import joined_classes

VALENCES = (3, 5)
"""Fewest and most quads around a node inside."""


def contract(mesh: QuadMesh, rungs: NDArray[np.bool_]) -> QuadMesh | None:
    """Return the mesh with the nodes of each edge in `rungs` (e,) made one; None where it would be invalid.

    That is where two corners would become one, wall nodes that no wall edges in `rungs` join, or where what
    is left is no conforming mesh of the same domain with 3 to 5 quads around each node inside.
    """
    pairs = np.ascontiguousarray(mesh.edges[rungs])
    label, count = joined_classes(pairs, len(mesh.nodes))
    merged = _merged_places(mesh, label, count, pairs[mesh.on_wall[rungs]])
    kept = ~rungs[mesh.edge_of].any(axis=1)
    if merged is None or not kept.any():
        return None
    places, nodes = merged
    trial = QuadMesh(mesh.domain, nodes, label[mesh.quads[kept]], places)
    return trial if is_conforming(trial) else None


def _merged_places(
    mesh: QuadMesh, label: Indices, count: int, wall_rungs: Indices
) -> tuple[Places, Floats] | None:
    """Return places and nodes (count, 2) of classes of nodes."""
    places, size = mesh.places, np.bincount(label, minlength=count)
    corners, wall = np.flatnonzero(places.cells > 0), np.flatnonzero(places.loop >= 0)
    of_wall = np.bincount(label[wall], minlength=count)
    links = np.bincount(label[wall_rungs[:, 0]], minlength=count)
    if (np.bincount(label[corners], minlength=count) > 1).any() or (
        (of_wall > 1) & (links != of_wall - 1)
    ).any():
        return None
    loop, arc, cells = np.full(count, -1), np.zeros(count), np.zeros(count, dtype=np.intp)
    loop[label[wall]] = places.loop[wall]
    first = np.zeros(count)
    first[label[wall[::-1]]] = places.arc[wall[::-1]]
    length = np.array([one.length for one in mesh.domain.loops])[places.loop[wall]]
    off = np.mod(places.arc[wall] - first[label[wall]] + 0.5 * length, length) - 0.5 * length
    arc = first + np.bincount(label[wall], off, minlength=count) / np.maximum(of_wall, 1)
    nodes = np.stack([np.bincount(label, axis, minlength=count) / size for axis in mesh.nodes.T], axis=1)
    nodes[label[wall]] = mesh.nodes[wall]
    for number, one in enumerate(mesh.domain.loops):
        moved = np.flatnonzero((loop == number) & (of_wall > 1))
        arc[loop == number] %= one.length
        nodes[moved] = one.at(arc[moved])
    loop[label[corners]], arc[label[corners]] = places.loop[corners], places.arc[corners]
    cells[label[corners]], nodes[label[corners]] = places.cells[corners], mesh.nodes[corners]
    return Places(loop, arc, cells, np.full(count, -1)), nodes


def is_conforming(mesh: QuadMesh) -> bool:
    """Return whether the quads are a mesh of the domain: manifold, holes kept, wall nodes on walls.

    Nodes inside have as many quads as `VALENCES` allow.
    """
    quads, n = mesh.quads, len(mesh.nodes)
    if not mesh.manifold or n - len(mesh.edges) + len(quads) != 2 - len(mesh.domain.loops):
        return False
    repeated = [(quads == np.roll(quads, k, axis=1)).any() for k in (1, 2)]
    wall = mesh.wall_nodes
    if any(repeated) or not np.array_equal(wall, mesh.places.loop >= 0):
        return False
    around = np.bincount(mesh.edges[mesh.on_wall].ravel(), minlength=n)
    inside = mesh.valence[~wall]
    fits = not inside.size or (inside.min() >= VALENCES[0] and inside.max() <= VALENCES[1])
    return bool((around[wall] == 2).all() and fits)
