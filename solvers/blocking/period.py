"""A quad mesh that closes on itself across a period, cut open along its lines.

Across a period there is no wall, so lines of the map run through, and the mesh covers the domain's quotient
by the shift. Where it is cut open is free: along a line of the mesh between the ends of the given stretch.
"""

from __future__ import annotations

import heapq
from dataclasses import replace
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, complex_of
from meshonet.geometry.domain.domain import Domain, Periodic
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.ties import less
from meshonet.solvers.blocking.errors import BlockingError

BEND = 0.5
"""What a right-angled bend of the cut costs, as a part of the pitch."""
AWAY = 4.0
"""What a pitch of distance from the given stretch costs, by length."""


def cut_open(mesh: QuadMesh, ends: tuple[int, int]) -> QuadMesh:
    """Return a closed mesh cut from one node to another, which are both ends of the first stretch.

    Nodes of the cut come twice: the second has the first as its partner, is the first moved by the shift, and
    neither is on a loop, but for the ends.

    Raises BlockingError: no line joins the ends beside the domain's walls.
    """
    domain = mesh.domain
    if domain.periodic is None:
        raise ValueError("a domain without periodic stretches")
    shift = complex(*domain.periodic.shift)
    z = complex_of(mesh.nodes)
    quads = mesh.quads
    # how many shifts each corner lies from where its node is, to be beside the first corner
    off = np.round(((z[quads[:, :1]] - z[quads]) / shift).real).astype(np.intp)
    path = _path(mesh, z, ends, shift)
    copy = off + _copies(quads, off, path, mesh.places.loop, ends)[:, None]
    low = np.full(len(z), np.iinfo(np.intp).max)
    high = np.full(len(z), np.iinfo(np.intp).min)
    np.minimum.at(low, quads, copy)
    np.maximum.at(high, quads, copy)
    double = np.flatnonzero(high > low)
    wall = mesh.places.loop >= 0
    wall[list(ends)] = False
    if sorted(double.tolist()) != sorted(path) or np.any(high[double] != low[double] + 1) or low[wall].any():
        raise BlockingError("the mesh of a periodic domain cannot be cut open beside its walls")
    number = np.full(len(z), -1, dtype=np.intp)
    number[double] = len(z) + np.arange(len(double))
    again = (copy > low[quads]) & (number[quads] >= 0)
    points = np.concatenate([z + low * shift, z[double] + high[double] * shift])
    xy = np.ascontiguousarray(np.stack([points.real, points.imag], axis=1))
    places = _places(mesh, domain.periodic, ends, double)
    return QuadMesh(domain, xy, np.where(again, number[quads], quads), places)


def _places(mesh: QuadMesh, periodic: Periodic, ends: tuple[int, int], double: Indices) -> Places:
    """Return the places of all nodes and of the copies of some."""
    places = mesh.places
    loop, arc = np.append(places.loop, places.loop[double]), np.append(places.arc, places.arc[double])
    cells = np.append(places.cells, places.cells[double])
    partner = np.append(np.full(len(places.loop), -1, dtype=np.intp), double)
    length = mesh.domain.loops[0].length
    corners, wanted = mesh.domain.loops[0].corner_arcs, mesh.domain.loops[0].corner_cells
    for end, first, second in zip(ends, periodic.first, periodic.second[::-1], strict=True):
        for node, at in ((end, first), (len(places.loop) + int(np.flatnonzero(double == end)[0]), second)):
            apart = np.abs(np.mod(corners - at + length / 2, length) - length / 2)
            loop[node], arc[node] = 0, at % length
            cells[node] = wanted[np.argmin(apart)] if len(corners) else 1
    return Places(loop, arc, cells, partner)


def _path(mesh: QuadMesh, z: Complexes, ends: tuple[int, int], shift: complex) -> list[int]:
    """Return the nodes of the cheapest way along edges from end to end: short, straight, near the stretch."""
    pitch = abs(shift)
    away = _distance(mesh.domain, z, shift) / pitch
    onward: dict[int, list[int]] = {}
    for a, b in mesh.edges[~mesh.on_wall].tolist():
        onward.setdefault(a, []).append(b)
        onward.setdefault(b, []).append(a)
    beside = {frozenset((q[i - 1], q[i], q[(i + 1) % 4])) for q in mesh.quads.tolist() for i in range(4)}
    shut = mesh.places.loop >= 0
    start, stop = ends
    heap: list[tuple[float, int, int]] = [(0.0, -1, start)]
    came: dict[tuple[int, int], tuple[int, int]] = {}
    best = {(-1, start): 0.0}
    while heap:
        cost, before, at = heapq.heappop(heap)
        if at == stop:
            path = [at]
            while before >= 0:
                before, at = came[before, at]
                path.append(at)
            return path
        if cost > best[before, at]:
            continue
        for to in onward.get(at, []):
            if shut[to] and to != stop:
                continue
            step = z[to] - z[at]
            step -= shift * np.round((step / shift).real)
            now = cost + abs(step) * (1.0 + AWAY * 0.5 * (away[at] + away[to]))
            if before >= 0 and frozenset((before, at, to)) in beside:
                now += BEND * pitch
            if less(now, best.get((at, to), np.inf)):
                best[at, to], came[at, to] = now, (before, at)
                heapq.heappush(heap, (now, at, to))
    raise BlockingError("no line of the mesh joins both ends of a periodic stretch")


def _distance(domain: Domain, z: Complexes, shift: complex) -> Floats:
    """Return how far points are from the nearest copy of the first stretch."""
    if domain.periodic is None:
        raise ValueError("a domain without periodic stretches")
    a, b = domain.periodic.first
    line = complex_of(domain.loops[0].at(np.linspace(a, b if b > a else b + domain.loops[0].length, 200)))
    copies = np.concatenate([line - shift, line, line + shift])
    return np.asarray(np.abs(z[:, None] - copies).min(axis=1))


def _copies(quads: Indices, off: Indices, path: list[int], loop: Indices, ends: tuple[int, int]) -> Indices:
    """Return by how many shifts each quad is moved, so that all hang together but across the path."""
    shut = {frozenset(pair) for pair in pairwise(path)}
    sides: dict[frozenset[int], list[tuple[int, int]]] = {}
    rows, offs = quads.tolist(), off.tolist()
    for q, row in enumerate(rows):
        for i in range(4):
            sides.setdefault(frozenset((row[i], row[(i + 1) % 4])), []).append((q, i))
    seeds = np.argwhere((loop[quads] >= 0) & ~np.isin(quads, ends))
    first, corner = seeds[0].tolist()
    moved = {first: -offs[first][corner]}
    queue = [first]
    for q in queue:
        for i in range(4):
            side = frozenset((rows[q][i], rows[q][(i + 1) % 4]))
            for neighbour, _ in sides[side]:
                if neighbour not in moved and side not in shut:
                    j = rows[neighbour].index(rows[q][i])
                    moved[neighbour] = moved[q] + offs[q][i] - offs[neighbour][j]
                    queue.append(neighbour)
    return np.array([moved.get(q, 0) for q in range(len(rows))], dtype=np.intp)


def as_first(mesh: QuadMesh, ends: tuple[int, int]) -> QuadMesh:
    """Return the closed mesh with the ends of the cut where the first stretch has them."""
    if mesh.domain.periodic is None:
        raise ValueError("a domain without periodic stretches")
    nodes, arc = mesh.nodes.copy(), mesh.places.arc.copy()
    for node, at in zip(ends, mesh.domain.periodic.first, strict=True):
        nodes[node] = mesh.domain.loops[0].at(np.array([at]))[0]
        arc[node] = at
    return QuadMesh(mesh.domain, nodes, mesh.quads, replace(mesh.places, arc=arc))
