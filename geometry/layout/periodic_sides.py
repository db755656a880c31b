"""Nodes of a mesh along the periodic sides of its domain, in pairs: one, and the same moved by the period.

Corners of the domain stay where they are. All other nodes of periodic sides move freely and together, so that
grid lines cross from one side to the other as they do inside; blocks need not end at the same nodes.
"""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, shortest_ways
from meshonet.geometry.domain.periodic import Periodic, rounded
from meshonet.geometry.layout.quad_mesh import QuadMesh

Sides = tuple[Periodic, Indices, Indices]
"""Two periodic sides, and the nodes of each with its corners, in the order of the first."""


def sides_of(mesh: QuadMesh) -> list[Sides]:
    """Return each periodic pair of sides, with the nodes of its first and of its second side."""
    after = following(mesh)
    return [
        (each, _chain(mesh, after, each.first), _chain(mesh, after, each.second)[::-1])
        for each in mesh.domain.periodic
    ]


def following(mesh: QuadMesh) -> Indices:
    """Return the next node (n,) along the boundary (domain on the left) for each node; -1 for inner nodes."""
    cell, side = np.nonzero(mesh.on_wall[mesh.edge_of])
    after = np.full(len(mesh.nodes), -1, dtype=np.intp)
    after[mesh.quads[cell, side]] = mesh.quads[cell, (side + 1) % 4]
    return after


def with_tied_sides(mesh: QuadMesh) -> QuadMesh:
    """Return the mesh after nodes of periodic sides are paired, and moved to differ by exactly the period."""
    if not mesh.domain.periodic:
        return mesh
    places, nodes = mesh.places, mesh.nodes.copy()
    loop, partner = places.loop.copy(), places.partner.copy()
    for each, first, second in sides_of(mesh):
        own, image = first[1:-1], second[1:-1]
        nodes[own] = 0.5 * (nodes[own] + nodes[image] - np.array(each.shift))
        nodes[image] = nodes[own] + np.array(each.shift)
        partner[image], loop[own], loop[image] = own, -1, -1
    return mesh.with_places(nodes, replace(places, loop=loop, partner=partner))


def matched_nodes(mesh: QuadMesh) -> Floats:
    """Return the nodes (n, 2), moved so that opposite periodic sides differ by exactly the period."""
    nodes, sides = mesh.nodes.copy(), sides_of(mesh)
    for _, first, _ in sides:
        nodes[first] = rounded(nodes[first], mesh.domain)
    for _ in range(2 * len(sides)):  # a corner may belong to two pairs
        for each, first, second in sides:
            nodes[second] = nodes[first] + np.array(each.shift)
    return nodes


def _chain(mesh: QuadMesh, after: Indices, stretch: tuple[float, float]) -> Indices:
    """Return the nodes along a stretch of the outer loop, both corners included."""
    begin, end = (_at(mesh, arc) for arc in stretch)
    return chain(after, begin, end)


def chain(after: Indices, begin: int, end: int) -> Indices:
    """Return the boundary nodes from `begin` to `end`, both included; for `after` see `following`.

    If `end` is `begin`, it is the whole loop, with this node twice.
    """
    nodes = [begin]
    while nodes[-1] != end or len(nodes) == 1:
        nodes.append(int(after[nodes[-1]]))
    return np.array(nodes, dtype=np.intp)


def _at(mesh: QuadMesh, arc: float) -> int:
    corners = np.flatnonzero((mesh.places.loop == 0) & (mesh.places.cells > 0))
    length = mesh.domain.loops[0].length
    apart = np.abs(shortest_ways(mesh.places.arc[corners] - arc, length))
    return int(corners[int(np.argmin(apart))])
