r"""A row of quads along a wall with a sharp edge, and along both sides of the grid line behind it.

::

    ---------------- front --------------.
                                          \
      wake   -------------------- edge  wall |      the nodes of the path wake, wall, wake are doubled,
                                          /       with a quad at each of its edges: a C
    ---------------- front --------------'
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh

INSET = 0.25
"""Initial distance of fronts from the path, relative to the edges across."""
Half = dict[tuple[int, int], tuple[int, int]]


def has_sharp_edge(loop: Loop) -> bool:
    """Return whether a loop has a single corner that is so sharp that four cells meet there."""
    return len(loop.corners) == 1 and int(loop.corner_cells[0]) == 4


def wake_of(mesh: QuadMesh, number: int) -> list[int]:
    """Return the nodes of the grid line from the sharp edge of a loop to a boundary."""
    half = _half_edges(mesh)
    edge, ahead = _edge(mesh, number)[:2]
    wake = [edge, _turned(mesh, half, edge, ahead, 2)]
    while not mesh.wall_nodes[wake[-1]]:
        wake.append(_turned(mesh, half, wake[-1], wake[-2], int(mesh.valence[wake[-1]]) // 2))
    return wake


def with_sheet(mesh: QuadMesh, number: int) -> QuadMesh:
    """Return the mesh with this row; its quads are last, each from the path to the front."""
    half, wall, wake = _half_edges(mesh), _edge(mesh, number), wake_of(mesh, number)
    path = [*wake[:0:-1], *wall, *wake]
    n, count = len(mesh.nodes), len(path)
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
        way = arc[beside] - arc[node]
        way -= loop.length * np.round(way / loop.length)
        added.loop[i], added.arc[i] = on, np.mod(arc[node] + INSET * way, loop.length)
        nodes[n + i] = loop.at(added.arc[i : i + 1])[0]
    row = [[path[i], path[i + 1], n + i + 1, n + i] for i in range(count - 1)]
    return QuadMesh(mesh.domain, nodes, np.concatenate([quads, row]), mesh.places.and_then(added))


def _half_edges(mesh: QuadMesh) -> Half:
    """Return the quad, and which of its nodes, at which an edge from one node to another begins."""
    return {(q[i], q[(i + 1) % 4]): (k, i) for k, q in enumerate(mesh.quads.tolist()) for i in range(4)}


def _edge(mesh: QuadMesh, number: int) -> list[int]:
    """Return the nodes of a loop in order, the domain on their left, from its sharp edge on."""
    on = mesh.on_wall[mesh.edge_of] & (mesh.places.loop[mesh.quads] == number)
    after = dict(zip(mesh.quads[on].tolist(), np.roll(mesh.quads, -1, axis=1)[on].tolist(), strict=True))
    chain = [next(node for node in after if mesh.places.cells[node] == 4)]
    while after[chain[-1]] != chain[0]:
        chain.append(after[chain[-1]])
    return chain


def _turned(mesh: QuadMesh, half: Half, node: int, beside: int, steps: int) -> int:
    """Return the neighbour of a node that follows another one after a number of quads, counter-clockwise."""
    for _ in range(steps):
        k, i = half[node, beside]
        beside = int(mesh.quads[k, (i + 3) % 4])
    return beside


def _left_of(
    mesh: QuadMesh, half: Half, node: int, ahead: int | None, behind: int | None
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
