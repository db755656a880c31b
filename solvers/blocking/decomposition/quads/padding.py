"""Inserts a row of quads along smooth walls on which the field has singularities.

A loop without corners, such as a circle, may have nodes at which other than two quads meet. With a ring of
quads along the loop they become irregular interior nodes, and all nodes on the wall are regular. A row of
quads along a stretch between two corners with one quad each has the same effect.

Mitchell, Tautges, "Pillowing doublets: refining a mesh to ensure that faces share at most one edge", 4th
International Meshing Roundtable (1995).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, distinct, turned_left
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.periodic_sides import following
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh

INSET = 0.25
"""Displacement of old wall nodes into the domain, relative to the shorter adjacent edge."""

Span = tuple[int, float, float]
"""Number of a loop, and the arc lengths of the corners at which a stretch of it starts and ends."""


def wrong_count(mesh: QuadMesh) -> Bools:
    """Return a mask (n,) of boundary nodes with a wrong number of quads, which is 2 except at corners."""
    cells = mesh.places.cells
    return np.asarray(mesh.wall_nodes & (mesh.valence != np.where(cells > 0, cells, 2)))


def loops_to_pad(mesh: QuadMesh) -> list[int]:
    """Return the numbers of loops without corners on which some node has a wrong number of quads."""
    wrong = distinct(mesh.places.loop[wrong_count(mesh)])
    return [int(loop) for loop in wrong if loop >= 0 and not mesh.domain.loops[loop].corners]


def spans_to_pad(mesh: QuadMesh, spans: Sequence[Span]) -> list[Span]:
    """Return the stretches in `spans` within which some node has a wrong number of quads."""
    places, wrong = mesh.places, wrong_count(mesh)
    return [
        (loop, begin, end)
        for loop, begin, end in spans
        if wrong[(places.loop == loop) & (places.arc > begin) & (places.arc < end)].any()
    ]


def pad(mesh: QuadMesh, loops: list[int]) -> QuadMesh:
    """Return the mesh with a ring of quads along these loops; old wall nodes become interior nodes.

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
    after = following(mesh)
    along = np.flatnonzero((after >= 0) & np.isin(mesh.places.loop, loops))
    ahead = after[along]
    n, k = len(mesh.nodes), len(along)
    copy = np.full(n, -1, dtype=np.intp)
    copy[along] = n + np.arange(k)
    ring = np.stack([copy[along], copy[ahead], ahead, along], axis=1)
    before = np.empty(n, dtype=np.intp)
    before[ahead] = along
    nodes = np.concatenate([mesh.nodes, mesh.nodes[along]])
    nodes[along] += _inwards(mesh.nodes, before[along], along, ahead)
    return QuadMesh(mesh.domain, nodes, np.concatenate([mesh.quads, ring]), _moved(mesh.places, along))


def _inwards(nodes: Floats, before: Indices, along: Indices, ahead: Indices) -> Floats:
    """Return by what wall nodes (k,) move inside, between those before and ahead of them."""
    here, last, coming = nodes[along], nodes[before], nodes[ahead]
    tangent = coming - last
    tangent /= np.hypot(*tangent.T)[:, None]
    shorter = np.minimum(np.hypot(*(here - last).T), np.hypot(*(coming - here).T))
    return np.asarray(INSET * shorter[:, None] * turned_left(tangent))


def pad_span(mesh: QuadMesh, span: Span) -> QuadMesh:
    """Return the mesh with a row of quads along a stretch between two corners with one quad each.

    Old nodes at these corners move along the adjacent walls. If both corners are the same, the row is closed.
    """
    number, begin, end = span
    places, loop = mesh.places, mesh.domain.loops[number]
    after = following(mesh)
    along = np.flatnonzero((after >= 0) & (places.loop == number))
    arcs = places.arc[along]
    chain = [int(along[np.argmin(np.abs(arcs - begin))])]
    last = int(along[np.argmin(np.abs(arcs - end % loop.length))])
    while chain[-1] != last or len(chain) == 1:
        chain.append(int(after[chain[-1]]))
    line, n = np.array(chain), len(mesh.nodes)
    new = n + np.arange(len(line))
    nodes = np.concatenate([mesh.nodes, mesh.nodes[line]])
    row = np.stack([new[:-1], new[1:], line[1:], line[:-1]], axis=1)
    inner = line[1:-1]
    nodes[inner] += _inwards(mesh.nodes, line[:-2], inner, line[2:])
    moved = _moved(places, line)
    if line[0] == line[-1]:  # all of the loop: the row crosses itself, in a quad at a corner of its own
        corner, first = n + len(line), int(line[0])
        ends = (int(new[0]), int(line[1]), begin), (int(new[-1]), int(line[-2]), end)
        row = np.concatenate([row, [[corner, new[0], first, new[-1]]]])
        nodes[first] += _inwards(mesh.nodes, line[-2:-1], line[:1], line[1:2])[0]
        nodes = np.concatenate([nodes, mesh.nodes[line[:1]]])
        moved = Places(*(np.append(values, values[new[0]]) for values in vars(moved).values()))
        moved.cells[new[[0, -1]]], moved.cells[corner] = 0, 1
    else:
        previous = int(np.flatnonzero(after == line[0])[0])
        ends = (int(line[0]), previous, begin), (last, after[last], end)
        moved.cells[new[[0, -1]]] = 1
    for node, beyond, arc in ends:
        moved.loop[node], moved.arc[node] = number, towards(loop, arc, places.arc[beyond])
        nodes[node] = loop.at(moved.arc[node : node + 1])[0]
    return QuadMesh(mesh.domain, nodes, np.concatenate([mesh.quads, row]), moved)


def towards(loop: Loop, arc: float, beyond: float) -> float:
    """Return the arc length at the fraction `INSET` of the shorter way from `arc` to `beyond` on a loop."""
    way = beyond - arc
    way -= loop.length * np.round(way / loop.length)
    return float(np.mod(arc + INSET * way, loop.length))


def _moved(places: Places, along: Indices) -> Places:
    """Return the places after those of the nodes `along` a loop went to copies behind all others."""
    copies = replace(places.take(along), partner=places.partner[along])
    copies.cells[copies.cells > 0] = 2
    moved = places.and_then(copies)
    moved.loop[along], moved.arc[along], moved.cells[along], moved.partner[along] = -1, 0.0, 0, -1
    return moved
