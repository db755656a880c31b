"""Inserts rows of quads along paths of edges through a mesh, such as a row around a corner.

::

    front ---+-----+-----+---
             |     |     |         nodes of the path are doubled: quads on its left get copies
    path  ---+-----+-----+---
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Indices, distinct
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.solvers.blocking.decomposition.quads.padding import INSET, towards

HalfEdges = dict[tuple[int, int], tuple[int, int]]


def half_edges(mesh: QuadMesh) -> HalfEdges:
    """Return for each edge (a, b) of a quad the number of the quad, and the index of node a in it."""
    return {(q[i], q[(i + 1) % 4]): (k, i) for k, q in enumerate(mesh.quads.tolist()) for i in range(4)}


def with_row(mesh: QuadMesh, path: Sequence[int]) -> QuadMesh:
    """Return the mesh with a row of quads inserted on the left of a path of nodes.

    The path goes from wall to wall, or along a closed loop, which may be a wall. The quads of the row are the
    last of the mesh; each begins at the path and ends at the front.
    """
    half, n, count = half_edges(mesh), len(mesh.nodes), len(path)
    quads, nodes = mesh.quads.copy(), np.concatenate([mesh.nodes, mesh.nodes[path]])
    added = Places.inside(count)
    for i, node in enumerate(path):
        ahead = path[i + 1] if i + 1 < count else None
        behind = path[i - 1] if i else None
        corners = _left_of(mesh, half, node, ahead, behind)
        quads[tuple(np.array(corners).T)] = n + i
        if ahead is not None and behind is not None:
            middle = np.mean([mesh.nodes[mesh.quads[k]].mean(axis=0) for k, _ in corners], axis=0)
            nodes[n + i] = (1.0 - INSET) * mesh.nodes[node] + INSET * middle
            continue
        on = int(mesh.places.loop[node])  # the end of a front slides along the loop where the wake ends
        loop, arc = mesh.domain.loops[on], mesh.places.arc
        around = [int(mesh.quads[k, (j + d) % 4]) for k, j in corners for d in (1, 3)]
        beside = next(v for v in around if mesh.places.loop[v] == on and v != node)
        added.loop[i], added.arc[i] = on, towards(loop, arc[node], arc[beside])
        nodes[n + i] = loop.at(added.arc[i : i + 1])[0]
    row = [[path[i], path[i + 1], n + i + 1, n + i] for i in range(count - 1)]
    return QuadMesh(mesh.domain, nodes, np.concatenate([quads, row]), mesh.places.and_then(added))


def _left_of(
    mesh: QuadMesh, half: HalfEdges, node: int, ahead: int | None, behind: int | None
) -> list[tuple[int, int]]:
    """Return the quads to the left of a path at a node, and which of their nodes it is.

    They are counted from the edge ahead round to the one behind, or, where the path ends, the other way.
    """
    corners = []
    if ahead is not None:
        while (node, ahead) in half:
            k, i = half[node, ahead]
            corners.append((k, i))
            ahead = int(mesh.quads[k, (i + 3) % 4])
            if ahead == behind:
                break
    elif behind is not None:
        while (behind, node) in half:
            k, i = half[behind, node]
            corners.append((k, (i + 1) % 4))
            behind = int(mesh.quads[k, (i + 2) % 4])
    return corners


def corner_row(mesh: QuadMesh, corner: int, farthest: int) -> QuadMesh | None:
    """Return the mesh with a row of quads inserted around a corner of the domain at which one quad meets.

    `corner` is the number of its node. The row is placed as far from the corner as all nodes up to there are
    regular, but at most `farthest` quads away. Return None if irregular nodes are next to the corner.
    """
    for size in range(farthest, 0, -1):
        lattice = _lattice(mesh, corner, size)
        if lattice is not None:
            return with_row(mesh, [*lattice[-1].tolist(), *lattice[-2::-1, -1].tolist()])
    return None


def _lattice(mesh: QuadMesh, corner: int, size: int) -> Indices | None:
    """Return the nodes (size + 1, size + 1) of a lattice from a corner on; None if it is irregular."""
    quads, twin = mesh.quads, mesh.twin
    cell, first = (int(values[0]) for values in np.nonzero(quads == corner))
    nodes = np.empty((size + 1, size + 1), dtype=np.intp)
    starts = (cell, first)
    for b in range(size):
        cell, first = starts
        for a in range(size):
            around = np.roll(quads[cell], -first)
            if a and b and nodes[a, b] != around[0]:
                return None
            nodes[a : a + 2, b], nodes[a : a + 2, b + 1] = around[:2], around[[3, 2]]
            up, right = twin[cell, (first + 2) % 4], twin[cell, (first + 1) % 4]
            if up < 0 or right < 0:
                return None
            if a == 0:
                starts = (int(up) // 4, int(up) % 4)
            cell, first = int(right) // 4, (int(right) % 4 + 1) % 4
    inner = mesh.valence[nodes[1:, 1:]]
    walls = mesh.wall_nodes[nodes[0]].all() and mesh.wall_nodes[nodes[:, 0]].all()
    regular = walls and (inner == 4).all() and len(distinct(nodes.ravel())) == nodes.size
    return nodes if regular else None
