"""Pairs of consecutive edges along the grid lines of a mesh, and the limits of their ratios."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats, Indices, complex_of
from meshonet.geometry.blocks.shared_nodes import joined_labels
from meshonet.geometry.elementary import arctan2, log, modulus
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.kernels._native import line_neighbours


@dataclass(frozen=True, eq=False)
class GrowthLines:
    """Pairs of consecutive edges along grid lines, and the limits of their length ratios.

    Parameters
    ----------
    nodes : (k, 3) the three nodes of each pair, in order along the grid line.
    limit : (k,) logarithms of the largest permitted ratios of edge lengths.
    offset : (k,) terms that are added to the logarithms of the ratios before the comparison with the limits.
    begins : (k,) node at which the second edge begins: the middle node, or its partner on a periodic side.
    """

    nodes: Indices
    limit: Floats
    offset: Floats
    begins: Indices

    @classmethod
    def of(cls, mesh: QuadMesh, limit: float, factors: Floats | None = None) -> Self:
        """Return all pairs of consecutive edges of grid lines; `limit` is the logarithm of the largest ratio.

        If `factors` (e,) are given, edge lengths are multiplied by them before ratios are computed.
        """
        nodes, begins = _pairs(mesh)
        offset = np.zeros(len(nodes))
        if factors is not None:
            before, after = _edges_of(mesh, nodes, begins)
            offset = log(factors[after] / factors[before])
        return cls(nodes, np.full(len(nodes), limit), offset, begins)

    @classmethod
    def from_walls(
        cls, layout: Layout, walls: Bools, limit: float, elsewhere: float, sliding: Bools | bool = False
    ) -> Self:
        """Return all pairs of consecutive edges on grid lines, each with a limit on its length ratio.

        Limits are logarithms: `limit` on lines that start at the nodes in the mask `walls` (n,), and where
        lines cross from block to block; `elsewhere` on other lines. In the blocks beside a wall, ratios along
        the wall may be as large as at the wall itself, not counting wall nodes in the mask `sliding` (n,).
        """
        mesh, pairs = layout.mesh, cls.of(layout.mesh, elsewhere)
        nodes = pairs.nodes
        before, after = _edges_of(mesh, nodes, pairs.begins)
        leaving = _leaving(layout, walls)
        rows = layout.beside(walls)
        beside = np.zeros(len(mesh.edges), dtype=bool)  # along walls in the blocks beside them
        for table in rows:
            beside[mesh.edges_between(table[:-1], table[1:])] = True
        along = beside[before] & beside[after]
        side = np.zeros(len(mesh.edges), dtype=bool)
        for line in _sides(layout):
            side[mesh.edges_between(line[:-1], line[1:])] = True
        on_side, vertex = (np.zeros(len(mesh.nodes), dtype=bool) for _ in range(2))
        on_side[mesh.edges[side]] = True
        vertex[layout.vertices] = True
        middle = nodes[:, 1]
        strict = (vertex[middle] | (on_side[middle] & ~side[before])) & ~along
        strict |= leaving[before] | leaving[after]
        strict &= ~mesh.irregular[middle] | mesh.wall_nodes[middle]
        limits = np.where(strict, limit, elsewhere)
        own = along & ~strict
        on_walls = pairs.some((walls & ~np.asarray(sliding))[nodes].all(axis=1))
        limits[own] = np.maximum(elsewhere, on_walls.largest_at(mesh, rows)[middle[own]])
        return replace(pairs, limit=limits)

    def some(self, which: Bools) -> Self:
        """Return only those pairs of consecutive edges that are in the mask `which` (k,)."""
        return type(self)(self.nodes[which], self.limit[which], self.offset[which], self.begins[which])

    def growth(self, z: Complexes) -> Floats:
        """Return log(second length / first length) + `offset` (k,) of pairs of edges, for nodes `z` (n,)."""
        before, after = self.edges(z)
        return np.asarray(log(modulus(after) / modulus(before)) + self.offset)

    def edges(self, z: Complexes) -> tuple[Complexes, Complexes]:
        """Return the first and the second edges (k,) of pairs, complex vectors between the nodes `z` (n,)."""
        return z[self.nodes[:, 1]] - z[self.nodes[:, 0]], z[self.nodes[:, 2]] - z[self.begins]

    def largest_at(self, mesh: QuadMesh, rows: list[Indices]) -> Floats:
        """Return, for each node (n,), the largest |log(length ratio)| of consecutive edges that meet there.

        Each table of `rows` has node indices (lines, m). On a line, no value is below that of its first node.
        """
        growth = np.zeros(len(mesh.nodes))
        np.maximum.at(growth, self.nodes[:, 1], np.abs(self.growth(complex_of(mesh.nodes))))
        for table in rows:
            growth[table] = np.maximum(growth[table], growth[table[:, :1]])
        return growth


def _pairs(mesh: QuadMesh) -> tuple[Indices, Indices]:
    """Return the nodes (k, 3) of all pairs of consecutive edges, and where (k,) the second edges begin."""
    edges = np.arange(len(mesh.edges))
    beside, _ = line_neighbours(
        np.ascontiguousarray(mesh.quads), mesh.edge_of, np.arange(len(mesh.nodes)), edges
    )
    first, second = np.repeat(edges, beside.shape[1]), beside.ravel()
    one, other = mesh.edges[first[first < second]], mesh.edges[second[first < second]]
    parts = []
    for i, j in ((0, 0), (0, 1), (1, 0), (1, 1)):
        meet = one[:, i] == other[:, j]
        parts.append(np.stack([one[meet, 1 - i], one[meet, i], other[meet, 1 - j]], axis=1))
    nodes, (across, begins) = np.concatenate([*parts, _around_irregular(mesh)]), _across_periodic(mesh)
    return np.concatenate([nodes, across]), np.concatenate([nodes[:, 1], begins])


def _across_periodic(mesh: QuadMesh) -> tuple[Indices, Indices]:
    """Return `_pairs` across periodic sides, also at their ends, if one edge leads inwards on each side."""
    images, on = np.flatnonzero(mesh.places.partner >= 0), mesh.tied
    own = mesh.places.partner[images]
    end, _ = _leading(mesh.edges[mesh.on_wall], on)
    last = (end[images] >= 0) & (end[own] >= 0)
    images, own = np.append(images, end[images[last]]), np.append(own, end[own[last]])
    on[images] = on[own] = True
    inwards, count = _leading(mesh.edges, on)
    single = (count[images] == 1) & (count[own] == 1)
    images, own = images[single], own[single]
    return np.stack([inwards[own], own, inwards[images]], axis=1), images


def _leading(edges: Indices, on: Bools) -> tuple[Indices, Indices]:
    """Return, for nodes in the mask `on` (n,), a neighbour outside the mask and the number of such ones."""
    to, count = np.full(len(on), -1, dtype=np.intp), np.zeros(len(on), dtype=np.intp)
    for ends in (edges, edges[:, ::-1]):
        off = ends[on[ends[:, 0]] & ~on[ends[:, 1]]]
        to[off[:, 0]] = off[:, 1]
        count += np.bincount(off[:, 0], minlength=len(on))
    return to, count


def _around_irregular(mesh: QuadMesh) -> Indices:
    """Return the nodes (k, 3) of pairs of edges with one edge between them at interior irregular vertices."""
    parts = [np.empty((0, 3), dtype=np.intp)]
    for vertex in np.flatnonzero(mesh.irregular & ~mesh.wall_nodes).tolist():
        ends = mesh.edges[(mesh.edges == vertex).any(axis=1)]
        ends = ends.sum(axis=1) - vertex
        away = mesh.nodes[ends] - mesh.nodes[vertex]
        ends = ends[np.argsort(arctan2(away[:, 1], away[:, 0]), kind="stable")]
        parts.append(np.stack([ends, np.full(len(ends), vertex), np.roll(ends, -2)], axis=1))
    return np.concatenate(parts)


def _edges_of(mesh: QuadMesh, nodes: Indices, begins: Indices) -> tuple[Indices, Indices]:
    """Return the first and the second edge (k,) of pairs with these `nodes` (k, 3) and `begins` (k,)."""
    return mesh.edges_between(nodes[:, 0], nodes[:, 1]), mesh.edges_between(begins, nodes[:, 2])


def _sides(layout: Layout) -> list[Indices]:
    """Return the nodes of the four sides of each block: two that end its lines along i, two along j."""
    return [side for block in layout.blocks for side in (block[0], block[-1], block[:, 0], block[:, -1])]


def _leaving(layout: Layout, walls: Bools) -> Bools:
    """Return a mask (e,) of edges along lines of blocks that start at `walls` (n,), through all blocks."""
    mesh, sides = layout.mesh, _sides(layout)
    partner = mesh.places.partner
    image = np.where(partner >= 0, partner, np.arange(len(partner)))
    sizes = [len(side) - 1 for side in sides]
    ends = np.concatenate([np.stack([side[:-1], side[1:]], axis=1) for side in sides])
    ends = np.sort(image[ends], axis=1)
    number = np.repeat(np.arange(len(sides)) // 2, sizes)  # of the direction: 2 for each block
    _, edge = np.unique(ends[:, 0] * len(partner) + ends[:, 1], return_inverse=True)
    label = joined_labels(2 * len(layout.blocks) + len(ends), [(number, 2 * len(layout.blocks) + edge)])
    starts = {int(label[k // 2]) for k, side in enumerate(sides) if walls[side].all()}
    leaving = np.zeros(len(mesh.edges), dtype=bool)
    for k, block in enumerate(layout.blocks):
        for axis, table in enumerate((block, block.T)):
            if int(label[2 * k + axis]) in starts:
                leaving[mesh.edges_between(table[:-1], table[1:])] = True
    return leaving
