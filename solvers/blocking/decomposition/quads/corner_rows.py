"""Inserts rows of quads around corners at the ends of a periodic side with too few cells.

A row goes from one wall of the corner to the other. At its turn, the node away from the corner has five
quads, the one on its side three. Both walls get a cell, so that rows around both ends of a side leave the
adjacent pair of periodic sides alike.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Indices, distinct
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.quads.padding import INSET


def corner_row(mesh: QuadMesh, corner: int, farthest: int) -> QuadMesh | None:
    """Return the mesh with a row around a `corner` of one quad, as far from it as its quads are regular.

    `farthest` is the largest distance in quads. Returns None if there are irregular nodes beside the corner.
    """
    for size in range(farthest, 0, -1):
        lattice = _lattice(mesh, corner, size)
        if lattice is not None:
            return _with_row(mesh, *lattice)
    return None


def _lattice(mesh: QuadMesh, corner: int, size: int) -> tuple[Indices, Indices] | None:
    """Return nodes (size + 1, size + 1) from a corner on, and the quads between; None if irregular."""
    quads, twin = mesh.quads, mesh.twin
    cell, first = (int(values[0]) for values in np.nonzero(quads == corner))
    nodes, cells = np.empty((size + 1, size + 1), dtype=np.intp), np.empty((size, size), dtype=np.intp)
    starts = (cell, first)
    for b in range(size):
        cell, first = starts
        for a in range(size):
            around = np.roll(quads[cell], -first)
            if a and b and nodes[a, b] != around[0]:
                return None
            nodes[a : a + 2, b], nodes[a : a + 2, b + 1] = around[:2], around[[3, 2]]
            cells[a, b] = cell
            up, right = twin[cell, (first + 2) % 4], twin[cell, (first + 1) % 4]
            if up < 0 or right < 0:
                return None
            if a == 0:
                starts = (int(up) // 4, int(up) % 4)
            cell, first = int(right) // 4, (int(right) % 4 + 1) % 4
    inner = mesh.valence[nodes[1:, 1:]]
    walls = mesh.wall_nodes[nodes[0]].all() and mesh.wall_nodes[nodes[:, 0]].all()
    return (
        (nodes, cells)
        if walls and (inner == 4).all() and len(distinct(nodes.ravel())) == nodes.size
        else None
    )


def _with_row(mesh: QuadMesh, nodes: Indices, cells: Indices) -> QuadMesh:
    """Return the mesh with a row along the far sides of a lattice, copies of nodes on the corner's side."""
    path = np.concatenate([nodes[-1], nodes[-2::-1, -1]])
    inner = np.concatenate([nodes[-2, :-1], nodes[-2:-1, -2], nodes[-2::-1, -2]])
    copies = len(mesh.nodes) + np.arange(len(path))
    renumbered = np.arange(len(mesh.nodes))
    renumbered[path] = copies
    quads = mesh.quads.copy()
    quads[cells.ravel()] = renumbered[quads[cells.ravel()]]
    row = np.stack([copies[:-1], path[:-1], path[1:], copies[1:]], axis=1)
    moved = mesh.nodes[path] + INSET * (mesh.nodes[inner] - mesh.nodes[path])
    places = mesh.places.and_then(mesh.places.take(path))
    for end, beyond in ((0, nodes[-2, 0]), (-1, nodes[0, -2])):
        number = int(places.loop[path[end]])
        loop, arc = mesh.domain.loops[number], places.arc[path[end]]
        way = places.arc[beyond] - arc
        way -= loop.length * np.round(way / loop.length)
        places.arc[copies[end]] = np.mod(arc + INSET * way, loop.length)
        moved[end] = loop.at(places.arc[copies[[end]]])[0]
    return QuadMesh(mesh.domain, np.concatenate([mesh.nodes, moved]), np.concatenate([quads, row]), places)
