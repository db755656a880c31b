"""Inserts rows of quads along paths of edges through a mesh, such as a row around a corner.

::

    front ---+-----+-----+---
             |     |     |         nodes of the path are doubled: quads on its left get copies
    path  ---+-----+-----+---
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, distinct, turned_left
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh

INSET = 0.25
"""Distance of a front from its path, over the shorter wall edge or the distance to the middles of cells."""

HalfEdges = dict[tuple[int, int], tuple[int, int]]


def half_edges(mesh: QuadMesh) -> HalfEdges:
    """Return for each directed edge (a, b) the index of the quad on its left, and a's number (0-3) in it."""
    return {(q[i], q[(i + 1) % 4]): (k, i) for k, q in enumerate(mesh.quads.tolist()) for i in range(4)}


def with_row(mesh: QuadMesh, path: Sequence[int], *, closed: bool = False, of_wall: bool = False) -> QuadMesh:
    """Return the mesh with a row of quads inserted on the left of a path of nodes.

    The path goes from wall to wall or, if `closed`, from its last node back to the first. Each of its nodes
    gets a copy. The copies are moved to the left, and the row lies between the path and the copies. If the
    path is along a wall (`of_wall`), the copies stay on the wall, and the nodes of the path are moved. The
    new quads are the last ones of the mesh; each begins with its two nodes on the right side of the row. If a
    closed path begins at a corner of a wall with a single quad, another quad fills this corner, between the
    two ends of the row.
    """
    half, n, count = half_edges(mesh), len(mesh.nodes), len(path)
    new = list(range(n, n + count))
    base, front = (new, path) if of_wall else (path, new)
    quads, nodes = mesh.quads.copy(), np.concatenate([mesh.nodes, mesh.nodes[path]])
    copies = replace(mesh.places.take(np.array(path)), partner=mesh.places.partner[path])
    crossing = closed and mesh.places.cells[path[0]] == 1
    places = mesh.places.and_then(copies, Places.inside(2 * crossing))
    places.loop[front], places.arc[front], places.cells[front], places.partner[front] = -1, 0.0, 0, -1
    for i, node in enumerate(path):
        ahead = path[(i + 1) % count] if closed or i + 1 < count else None
        behind = path[i - 1] if closed or i else None
        corners = _left_of(mesh, half, node, ahead, behind)
        quads[tuple(np.array(corners).T)] = front[i]
        if ahead is not None and behind is not None:
            if of_wall:
                nodes[front[i]] += _inwards(*mesh.nodes[[behind, node, ahead]])
                continue
            middle = np.mean([mesh.nodes[mesh.quads[k]].mean(axis=0) for k, _ in corners], axis=0)
            nodes[front[i]] = (1.0 - INSET) * mesh.nodes[node] + INSET * middle
            continue
        on = int(mesh.places.loop[node])  # a front ends on the same loop as its path
        around = [int(mesh.quads[k, (j + d) % 4]) for k, j in corners for d in (1, 3)]
        beside = next(v for v in around if mesh.places.loop[v] == on and v not in (ahead, behind))
        nodes[front[i]], places.loop[front[i]], places.arc[front[i]] = _towards(mesh, node, beside)
    ends = [*range(1, count), 0][: count if closed else count - 1]
    row = [[base[i], base[k], front[k], front[i]] for i, k in enumerate(ends)]
    if crossing:
        row[0][0], row[-1][1] = n + count, n + count + 1
        row.append([base[0], n + count, front[0], n + count + 1])
        nodes = np.concatenate([nodes, np.zeros((2, 2))])
        for node, k in ((n + count, 1), (n + count + 1, -1)):
            nodes[node], places.loop[node], places.arc[node] = _towards(mesh, path[0], path[k])
    return QuadMesh(mesh.domain, nodes, np.concatenate([quads, row]), places)


def _inwards(before: Floats, here: Floats, after: Floats) -> Floats:
    """Return the displacement (2,) into the domain of a wall node between two others."""
    shorter, tangent = min(np.hypot(*(here - before)), np.hypot(*(after - here))), after - before
    return np.asarray(INSET * shorter * turned_left(tangent / np.hypot(*tangent)))


def _towards(mesh: QuadMesh, node: int, beside: int) -> tuple[Floats, int, float]:
    """Return point, loop and arc length at `INSET` of the way from one wall node to another."""
    number = int(mesh.places.loop[node])
    loop, (arc, beyond) = mesh.domain.loops[number], mesh.places.arc[[node, beside]].tolist()
    way = beyond - arc
    way -= loop.length * np.round(way / loop.length)
    place = np.mod(arc + INSET * way, loop.length)
    return loop.at(np.array([place]))[0], number, float(place)


def _left_of(
    mesh: QuadMesh, half: HalfEdges, node: int, ahead: int | None, behind: int | None
) -> list[tuple[int, int]]:
    """Return the quads to the left of a path at a node, and the index (0 to 3) of the node in each."""
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
    """Return the mesh with a new row of quads around a corner that has a single quad; None if none fits.

    The row goes from one wall at the corner to the other. It is `farthest` quads away from the corner, or
    fewer if irregular nodes are in the way.
    """
    for size in range(farthest, 0, -1):
        lattice = _lattice(mesh, corner, size)
        if lattice is not None:
            return with_row(mesh, [*lattice[-1].tolist(), *lattice[-2::-1, -1].tolist()])
    return None


def _lattice(mesh: QuadMesh, corner: int, size: int) -> Indices | None:
    """Return the nodes (size + 1, size + 1) of the lattice at a corner; None if one is irregular."""
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
