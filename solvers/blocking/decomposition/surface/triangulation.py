"""Triangulation of a domain with prescribed sizes at walls, on which the cross field is solved."""

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Indices, cross2
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError
from meshonet.kernels._native import DelaunayMesh
from meshonet.solvers.blocking.decomposition.surface.sizes import GROWTH, WallSizes, place_nodes, wall_sizes
from meshonet.solvers.blocking.decomposition.surface.surface import Triangulation

_BOX = 4  # nodes that the kernel has before ours
_SIDE = 2.0**29  # number of integer steps along the domain; the kernel's box is twice as wide
_LARGEST = 1.3
"""Size inside over the largest size at walls; 1 and 2 give 22 domains 471 and 467 blocks, not 431."""
_SMOOTHING, _SMOOTHINGS = 0.7, 3
"""Relaxation factor and number of smoothing steps; no smoothing gives 22 domains 456 blocks, not 431."""
_JITTER = 1.7e-3
"""Random displacement of nodes over their size: symmetric domains then have no ambiguous diagonals."""
_NEAREST = 1e-7  # distance of walls, relative to the extent, below which they cannot be distinguished


class _Frame:
    """Transformation to integer coordinates of 30 bits; the domain takes the middle half of the range."""

    def __init__(self, domain: Domain) -> None:
        points = np.concatenate([loop.curve.points for loop in domain.loops])
        low, high = points.min(axis=0), points.max(axis=0)
        self.scale = _SIDE / float((high - low).max())
        self.middle = low + 0.5 * (high - low)

    def whole(self, points: Floats) -> NDArray[np.int64]:
        return np.ascontiguousarray(np.rint((points - self.middle) * self.scale + _SIDE), dtype=np.int64)

    def real(self, places: NDArray[np.int64]) -> Floats:
        return (places - _SIDE) / self.scale + self.middle


class _Walls:
    """Nodes along the loops, and the triangulation to which they are added until it has all wall edges."""

    def __init__(self, domain: Domain, sizes: WallSizes, frame: _Frame, most: int) -> None:
        self.domain, self.sizes, self.frame, self.most = domain, sizes, frame, most
        self.mesh = DelaunayMesh()
        self.loop, self.arc = np.empty(0, dtype=np.intp), np.empty(0)
        self.points = np.empty((0, 2))

    def add(self, loop: Indices, arc: Floats) -> None:
        points, size = self.domain.at(loop, arc), np.empty(len(arc))
        for k, length in enumerate(self.domain.lengths):
            mine, here = loop == k, self.sizes.loop == k
            size[mine] = np.interp(arc[mine], self.sizes.arc[here], self.sizes.size[here], period=length)
        new = self.mesh.insert(self.frame.whole(points), size * self.frame.scale, _spread(len(arc)))
        if not new.all():
            self.refuse(loop, points, int(np.flatnonzero(~new)[0]))
        self.loop, self.arc = np.append(self.loop, loop), np.append(self.arc, arc)
        self.points = np.concatenate([self.points, points])

    def refuse(self, loop: Indices, points: Floats, node: int) -> None:
        (x, y), name = points[node], self.domain.loops[int(loop[node])].names[0]
        problem = f"the walls come too close to each other at ({x:.6g}, {y:.6g}), loop {loop[node]} ({name})"
        raise InputError(problem, "open the gap there, or join the loops")

    def edges(self) -> Indices:
        """Return the pairs (b, 2) of consecutive nodes along the loops."""
        order = np.lexsort((self.arc, self.loop))
        after = np.empty(len(order), dtype=np.intp)
        last = np.flatnonzero(np.diff(self.loop[order], append=-1))
        first = np.append(0, last[:-1] + 1)
        after[:-1] = order[1:]
        after[last] = order[first]
        return np.stack([order, after], axis=1)

    def recover(self) -> None:
        """Add missing wall edges: long ones are halved on the wall, short ones made by flips of edges."""
        lengths = self.domain.lengths
        while True:
            edges = self.edges()
            named = (edges + _BOX).astype(np.int32)
            there = self.mesh.are_edges(named)
            span = np.mod(self.arc[edges[:, 1]] - self.arc[edges[:, 0]], lengths[self.loop[edges[:, 0]]])
            halve = ~there & (span > self.sizes.smallest[self.loop[edges[:, 0]]])
            if not halve.any():
                self.mesh.set_walls(named[there], True)
                way = self.mesh.force(named[~there])
                stuck = way[:, 0] >= 0
                if not stuck.any():
                    self.mesh.set_walls(named, True)
                    return
                self.mesh.set_walls(named, False)
                halve[np.flatnonzero(~there)[stuck]] = True
                blocking = {frozenset(pair) for pair in way[stuck].tolist()}
                halve |= np.array([frozenset(pair) in blocking for pair in named.tolist()])
            if (span[halve] * self.frame.scale < _NEAREST * _SIDE).any() or len(self.arc) > self.most:
                self.refuse(self.loop, self.points, int(edges[np.flatnonzero(halve)[0], 0]))
            start = edges[halve, 0]
            loop = self.loop[start]
            self.add(loop, np.mod(self.arc[start] + 0.5 * span[halve], lengths[loop]))


def _spread(n: int) -> Indices:
    """Return an order (n,) in which to insert n nodes of a row: every second node last, and so on."""
    number = np.arange(n)
    level = np.where(number == 0, 64, np.frexp(np.maximum(number & -number, 1))[1] - 1)
    return np.argsort(-level, kind="stable")


def triangulate(
    domain: Domain, count: int = 1500, finer: tuple[Floats, Floats] | None = None, seed: int = 0
) -> Triangulation:
    """Return a triangulation of a domain with about `count` nodes, or more if walls need short edges.

    `finer` has points (m, 2) and the edge lengths (m,) around them. The same input and `seed` give bitwise
    the same result. Raises InputError if walls are so close to each other that they cannot be distinguished.
    """
    sizes = wall_sizes(domain, count, finer)
    frame = _Frame(domain)
    walls = _Walls(domain, sizes, frame, most=10 * count + 30_000)
    loop, arc = place_nodes(domain, sizes)
    walls.add(loop, arc)
    walls.recover()
    mesh, first = walls.mesh, len(walls.arc)
    sources, source_sizes = (np.empty((0, 2)), np.empty(0)) if finer is None else finer
    mesh.refine(
        (walls.edges() + _BOX).astype(np.int32),
        _LARGEST * sizes.largest * frame.scale,
        GROWTH,
        np.ascontiguousarray((sources - frame.middle) * frame.scale + _SIDE),
        np.ascontiguousarray(source_sizes * frame.scale),
        8 * count + 4 * first,
    )
    for _ in range(_SMOOTHINGS):
        mesh.smooth(first + _BOX, _SMOOTHING)
    mesh.shake(first + _BOX, _JITTER, seed)
    return _result(walls)


def _result(walls: _Walls) -> Triangulation:
    order = np.lexsort((walls.arc, walls.loop))
    places, _ = walls.mesh.nodes()
    triangles, neighbours, edge = walls.mesh.triangles()
    number = np.arange(len(places))
    number[order] = np.arange(len(order))
    points = np.concatenate([walls.points[order], walls.frame.real(places[len(order) :])])
    a, b, c = (points[number[triangles[:, k]]] for k in range(3))
    flat = np.flatnonzero(cross2(b - a, c - a) <= 0)
    if flat.size:
        walls.refuse(walls.loop[order], points, int(number[triangles[flat[0]]].min()))
    return Triangulation(
        walls.domain, points, number[triangles], walls.loop[order], walls.arc[order], neighbours, edge
    )
