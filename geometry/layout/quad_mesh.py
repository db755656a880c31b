"""Quadrilaterals that share nodes: the mesh that block decompositions work on."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.cached import cached_property
from meshonet.geometry.domain.domain import Domain
from meshonet.kernels._native import connect_quads

_PROJECTIONS = 3  # onto tangents of a loop, which converge quadratically


@dataclass(frozen=True, eq=False)
class Places:
    """Where on the boundary of its domain the nodes of a mesh are; each array has one entry per node."""

    loop: Indices
    """Number of the loop, -1 inside."""
    arc: Floats
    """Arc length on that loop, in [0, its length); 0 inside."""
    cells: Indices
    """Number of cells that should meet at a corner, which does not move; 0 for nodes that are no corners."""
    partner: Indices
    """Index of the partner, which is this node before it is moved by the period; -1 without a partner."""

    @classmethod
    def inside(cls, count: int) -> Places:
        """Return `Places` for `count` inner nodes: on no loop, no corners, without periodic partners."""
        none = np.full(count, -1, dtype=np.intp)
        return cls(none, np.zeros(count), np.zeros(count, dtype=np.intp), none.copy())

    def and_then(self, *others: Places) -> Places:
        """Return these positions and the positions `others`, joined in this order."""
        every = (self, *others)
        return Places(*(np.concatenate([getattr(each, name) for each in every]) for name in vars(self)))

    def along(self, loop: int) -> Indices:
        """Return the indices (k,) of the nodes on a loop, in order of arc length."""
        on = np.flatnonzero(self.loop == loop)
        return np.asarray(on[np.argsort(self.arc[on], kind="stable")])

    def take(self, nodes: Indices) -> Places:
        """Return the entries of the nodes with indices `nodes`, with all `partner` set to -1 (none)."""
        cleared = np.full(len(nodes), -1, dtype=np.intp)
        return Places(self.loop[nodes], self.arc[nodes], self.cells[nodes], cleared)


@dataclass(frozen=True, eq=False)
class QuadMesh:
    """Conforming quadrilaterals inside a domain.

    Parameters
    ----------
    domain : domain on whose loops the boundary nodes lie.
    nodes : (n, 2) coordinates.
    quads : (m, 4) node indices of each cell, counter-clockwise.
    places : positions of the boundary nodes on the loops.
    """

    domain: Domain
    nodes: Floats
    quads: Indices
    places: Places = field(repr=False)

    @cached_property
    def _sides(self) -> tuple[Indices, Indices, Indices, bool]:
        return connect_quads(np.ascontiguousarray(self.quads, dtype=np.intp), len(self.nodes))

    @property
    def edges(self) -> Indices:
        """Node indices (e, 2) of each edge, the lower index first; edges are in ascending order."""
        return self._sides[2]

    @property
    def edge_lengths(self) -> Floats:
        """Lengths (e,) of the edges."""
        first, second = self.nodes[self.edges].transpose(1, 2, 0)
        return np.hypot(*(second - first))

    def edges_between(self, first: Indices, second: Indices) -> Indices:
        """Return the indices of the edges from nodes `first` to nodes `second` (arrays of equal shape)."""
        low, high, n = np.minimum(first, second), np.maximum(first, second), len(self.nodes)
        return np.asarray(np.searchsorted(self.edges[:, 0] * n + self.edges[:, 1], low * n + high))

    @property
    def edge_of(self) -> Indices:
        """Index (m, 4) of the edge from each node of a quad to the next node of the same quad."""
        return self._sides[0]

    @property
    def twin(self) -> Indices:
        """For each edge of each quad (m, 4): 4 q + k if it is also edge k of another quad q, else -1."""
        return self._sides[1]

    @property
    def manifold(self) -> bool:
        """Whether every edge belongs to at most two quads, which traverse it in opposite directions."""
        return self._sides[3]

    @cached_property
    def on_wall(self) -> Bools:
        """Whether each edge (e,) belongs to one quad only."""
        return np.bincount(self.edge_of.ravel(), minlength=len(self.edges)) == 1

    @cached_property
    def wall_nodes(self) -> Bools:
        """Whether each node (n,) is on the boundary."""
        on = np.zeros(len(self.nodes), dtype=bool)
        on[self.edges[self.on_wall].ravel()] = True
        return on

    @cached_property
    def valence(self) -> Indices:
        """Number (n,) of quads that meet at each node."""
        return np.bincount(self.quads.ravel(), minlength=len(self.nodes))

    @cached_property
    def irregular(self) -> Bools:
        """Whether each node (n,) is irregular. A regular node belongs to 4 quads, or to 2 on the boundary."""
        return self.valence != np.where(self.wall_nodes, 2, 4)

    @cached_property
    def of_quads(self) -> dict[object, object]:
        """Cache of results that depend only on the quads; all meshes with the same quads share it."""
        return {}

    def aspects(self, lengths: Floats) -> Floats:
        """Return the aspect ratios (m,) of the quads, for edges with the given `lengths` (e,).

        The ratio is sqrt(b d / (a c)) with the lengths a, b, c, d of the sides, from the first node onwards.
        """
        sides = lengths[self.edge_of]
        return np.asarray(np.sqrt(sides[:, 1] * sides[:, 3] / (sides[:, 0] * sides[:, 2])))

    @property
    def tied(self) -> Bools:
        """Mask (n,) of nodes on periodic sides that are tied to a partner, a node on the opposite side."""
        tied = self.places.partner >= 0
        tied[self.places.partner[tied]] = True
        return tied

    def shifts(self, images: Indices) -> Floats:
        """Return the vectors (k, 2) to the nodes with indices `images` (k,) from their periodic partners."""
        known = np.array([each.shift for each in self.domain.periodic] or [(0.0, 0.0)])
        way = self.nodes[images] - self.nodes[self.places.partner[images]]
        off = np.hypot(*(way[:, None] - known).transpose(2, 0, 1))
        return np.asarray(known[off.argmin(axis=1)])

    def beside_partners(self, nodes: Floats) -> Floats:
        """Return `nodes` (n, 2); of two periodic sides, the second is put exactly a period from the first."""
        images = np.flatnonzero(self.places.partner >= 0)
        if images.size and self.domain.periodic:
            nodes = nodes.copy()
            nodes[images] = nodes[self.places.partner[images]] + self.shifts(images)
        return nodes

    def with_nodes(self, nodes: Floats, arc: Floats | None = None) -> QuadMesh:
        """Return the mesh with new `nodes` (n, 2); `arc` (n,): arc lengths along the boundary, 0 inside."""
        places = self.places if arc is None else replace(self.places, arc=arc)
        return self.with_places(nodes, places)

    def on_loops(self, which: Bools) -> QuadMesh:
        """Return the mesh with nodes in the mask `which` (n,) moved to the nearest points of their loops."""
        nodes, arc = self.nodes.copy(), self.places.arc.copy()
        for number, loop in enumerate(self.domain.loops):
            on = np.flatnonzero(which & (self.places.loop == number))
            if not on.size:
                continue
            for _ in range(_PROJECTIONS):
                arc[on] += ((nodes[on] - loop.at(arc[on])) * loop.tangent(arc[on])).sum(axis=1)
            arc[on] = np.mod(arc[on], loop.length)
            nodes[on] = loop.at(arc[on])
        return self.with_nodes(nodes, arc)

    def with_places(self, nodes: Floats, places: Places) -> QuadMesh:
        """Return the same quads with other coordinates `nodes` (n, 2) and `places` along the boundary."""
        moved = replace(self, nodes=nodes, places=places)
        known = ("_sides", "on_wall", "wall_nodes", "valence", "irregular", "of_quads")
        # these depend on the quads alone
        moved.__dict__.update({name: self.__dict__[name] for name in known if name in self.__dict__})
        return moved
