"""A layout in the plane of a passage map, cut from inlet to outlet and laid out beside its blade.

::

    inlet -------- cut, moved by the pitch -------- outlet      the cut runs along sides of blocks; its nodes
      |                                               |        are there twice, the second time as partners
    inlet ----------------- cut ------------------- outlet
"""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.chords import Chords
from meshonet.solvers.blocking.errors import BlockingError
from meshonet.solvers.blocking.passage_map import PassageMap

BLADE, INLET, OUTLET = 0, 1, 2
"""Numbers of the loops of a passage in the plane of its map."""


@dataclass(frozen=True, eq=False)
class Unwrapped:
    """A passage in its own plane.

    Parameters
    ----------
    nodes : (n, 2).
    blocks : lattices of node numbers.
    places : loops and arc lengths as in the plane of the map; nodes of the upper cut have partners.
    source : (n,) node in the plane of the map.
    lower, upper : (k,) nodes of both sides of the cut, from inlet to outlet.
    """

    nodes: Floats
    blocks: tuple[Indices, ...]
    places: Places
    source: Indices
    lower: Indices
    upper: Indices


def unwrap(layout: Layout, passage: PassageMap) -> Unwrapped:
    """Return the layout of a passage in its own plane, cut along sides of blocks.

    Raises BlockingError: no way along sides of blocks leads from inlet to outlet beside the blade.
    """
    mesh = layout.mesh
    cut = _cut(layout, passage)
    turns = _turns(mesh, passage, cut)
    quads, low = mesh.quads, turns.min()
    span = int(turns.max() - low) + 1
    keys, number = np.unique(quads * span + (turns - low), return_inverse=True)
    source, shift = np.divmod(keys, span)
    pitch = np.array([passage.pitch.real, passage.pitch.imag])
    principal = passage.back(mesh.nodes)
    nodes = principal[source] + (shift + low)[:, None] * pitch
    places = mesh.places.take(source)
    pair: dict[int, list[tuple[int, int]]] = {}
    for new, (node, turn) in enumerate(zip(source.tolist(), shift.tolist(), strict=True)):
        pair.setdefault(node, []).append((turn, new))
    if any(len(pair[node]) != 2 for node in cut.tolist()):
        raise BlockingError("the cut through the passage closes upon itself")
    ends = [sorted(pair[node]) for node in cut.tolist()]
    lower, upper = (np.array([each[k][1] for each in ends], dtype=np.intp) for k in (0, 1))
    places.partner[upper] = lower
    nodes[upper] = nodes[lower] + pitch
    corner = _corner_numbers(layout, number.reshape(quads.shape))
    return Unwrapped(nodes, corner, places, source, lower, upper)


def _cut(layout: Layout, passage: PassageMap) -> Indices:
    """Return nodes (k,) along sides of blocks, the shortest way from inlet to outlet off the blade."""
    mesh, chords = layout.mesh, Chords.of(layout)
    loop = mesh.places.loop
    points = mesh.nodes
    stretch = passage.stretching(points)
    links: dict[int, list[tuple[float, int, int]]] = {}
    for k, edge in enumerate(chords.edges):
        if chords.wall[k]:
            continue
        step = np.hypot(*np.diff(points[edge], axis=0).T)
        length = float((step / (0.5 * (stretch[edge[1:]] + stretch[edge[:-1]]))).sum())
        a, b = int(edge[0]), int(edge[-1])
        links.setdefault(a, []).append((length, b, k))
        links.setdefault(b, []).append((length, a, k))
    starts = [v for v in links if loop[v] == INLET]
    best = dict.fromkeys(starts, 0.0)
    before: dict[int, tuple[int, int]] = {}
    heap = [(0.0, v) for v in starts]
    while heap:
        far, v = heapq.heappop(heap)
        if far > best[v]:
            continue
        if loop[v] == OUTLET:
            return _path(chords, v, before)
        for length, w, k in links[v]:
            if loop[w] in (BLADE, INLET) or far + length >= best.get(w, np.inf):
                continue
            best[w] = far + length
            before[w] = (v, k)
            heapq.heappush(heap, (far + length, w))
    raise BlockingError("no sides of blocks lead from the inlet to the outlet")


def _path(chords: Chords, v: int, before: dict[int, tuple[int, int]]) -> Indices:
    pieces = []
    while v in before:
        w, k = before[v]
        edge = chords.edges[k]
        pieces.append(edge if edge[-1] == v else edge[::-1])
        v = w
    pieces.reverse()
    return np.concatenate([pieces[0][:1], *(piece[1:] for piece in pieces)])


def _turns(mesh: QuadMesh, passage: PassageMap, cut: Indices) -> Indices:
    """Return how many pitches (m, 4) each corner of each quad is from where `back` puts it.

    Neighbours across any edge but those of the cut agree.
    """
    quads, edge_of = mesh.quads, mesh.edge_of
    z = passage.back(mesh.nodes)
    closed = {tuple(sorted(pair)) for pair in zip(cut[:-1].tolist(), cut[1:].tolist(), strict=True)}
    open_edge = np.array([tuple(edge) not in closed for edge in mesh.edges.tolist()])
    own = np.zeros(quads.shape, dtype=np.intp)
    for corner in range(1, 4):
        before = z[quads[:, corner - 1]] + own[:, corner - 1, None] * _pair(passage.pitch)
        own[:, corner] = passage.shifts(z[quads[:, corner]], before)
    order = np.argsort(edge_of.ravel(), kind="stable")
    edge = edge_of.ravel()[order]
    twin = np.flatnonzero((edge[1:] == edge[:-1]) & open_edge[edge[1:]])
    neighbours: list[list[tuple[int, int, int]]] = [[] for _ in quads]
    for first, second in zip(order[twin].tolist(), order[twin + 1].tolist(), strict=True):
        neighbours[first // 4].append((first % 4, second // 4, second % 4))
        neighbours[second // 4].append((second % 4, first // 4, first % 4))
    added = np.zeros(len(quads), dtype=np.intp)
    seen = np.zeros(len(quads), dtype=bool)
    stack = [0]
    seen[0] = True
    while stack:
        q = stack.pop()
        for side, other, back in neighbours[q]:
            if not seen[other]:
                # the edge runs the other way in the neighbour: its end is the start here
                mine, its = own[q, side] + added[q], own[other, (back + 1) % 4]
                added[other] = mine - its
                seen[other] = True
                stack.append(other)
    return np.asarray(own + added[:, None])


def _corner_numbers(layout: Layout, number: Indices) -> tuple[Indices, ...]:
    """Return the blocks in numbers (m, 4) of quads' corners, the quads being those of block after block."""
    blocks, first = [], 0
    for block in layout.blocks:
        ni, nj = block.shape[0] - 1, block.shape[1] - 1
        part = number[first : first + ni * nj].reshape(ni, nj, 4)
        first += ni * nj
        lattice = np.empty(block.shape, dtype=np.intp)
        lattice[:-1, :-1], lattice[1:, :-1] = part[..., 0], part[..., 1]
        lattice[1:, 1:], lattice[:-1, 1:] = part[..., 2], part[..., 3]
        blocks.append(lattice)
    return tuple(blocks)


def _pair(value: complex) -> Floats:
    return np.array([value.real, value.imag])
