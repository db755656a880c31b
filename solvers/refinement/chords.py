"""Edges of the blocks of a layout, and the chords that they form: edges with equal counts of cells."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, distinct
from meshonet.geometry.cached import cached_property
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.wall_turning import corners_between, turning_between
from meshonet.geometry.elementary import exp, log, times
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.ties import nearest_whole
from meshonet.kernels._native import joined_classes

LEAST = 2  # smallest number of cells along an edge of a block
TURNING_DEG = 25.0  # largest angle in degrees by which a wall turns along a cell


@dataclass(frozen=True, eq=False)
class Chords:
    """Edges of blocks, and chords: sets of opposite edges, which must have the same number of cells."""

    layout: Layout
    edges: tuple[Indices, ...]
    sides: Indices  # (b, 4) edges at south, north, west and east of each block
    reversed: Bools  # (b, 4) whether the edge runs against the direction of the block
    wall: Bools  # (e,) whether an edge is on a wall
    partner: Indices  # (e,) the corresponding edge of the other periodic side, or -1
    chord: Indices  # (e,) chord of each edge and of its mirror image
    count: int
    images: Sequence[Indices]  # for each mirror, (n,) each node's mirror image

    @classmethod
    def of(cls, layout: Layout, images: Sequence[Indices] = ()) -> "Chords":
        """Return edges and chords (sets of opposite edges); an edge and its mirror image share a chord."""
        edges: list[Indices] = []
        numbers: dict[tuple[int, ...], int] = {}
        sides = np.empty((len(layout.blocks), 4), dtype=np.intp)
        turned = np.empty(sides.shape, dtype=bool)
        for b, block in enumerate(layout.blocks):
            for k, line in enumerate((block[:, 0], block[:, -1], block[0], block[-1])):
                key, turned[b, k] = _key(line)
                if key not in numbers:
                    numbers[key] = len(edges)
                    edges.append(line[::-1] if turned[b, k] else line)
                sides[b, k] = numbers[key]
        partner = _partners(layout, edges, numbers)
        has = np.flatnonzero(partner >= 0)
        wall = np.bincount(sides.ravel(), minlength=len(edges)) == 1
        wall[has], wall[partner[has]] = False, False
        tied = layout.mesh.tied
        if tied.any():
            wall &= [not tied[edge[1:-1]].any() for edge in edges]
        pairs = [sides[:, :2], sides[:, 2:], np.stack([has, partner[has]], axis=1)]
        for to in images:
            image = np.array([numbers.get(_key(to[edge])[0], -1) for edge in edges])
            pairs.append(np.stack([np.arange(len(edges)), image], axis=1)[image >= 0])
        chord, count = joined_classes(np.ascontiguousarray(np.concatenate(pairs)), len(edges))
        return cls(layout, tuple(edges), sides, turned, wall, partner, chord, count, images)

    def of_refined(self, layout: Layout) -> "Chords":
        """Return the chords (sets of opposite edges) of a `layout` with the same blocks, but other counts."""
        return replace(Chords.of(layout), chord=self.chord, count=self.count)

    @cached_property
    def counts(self) -> Indices:
        """Number of cells (chords,) along the edges of each chord (set of opposite edges of blocks)."""
        cells = np.empty(self.count, dtype=np.intp)
        cells[self.chord] = [len(edge) - 1 for edge in self.edges]
        return cells

    @cached_property
    def multiple(self) -> Indices:
        """Divisors (chords,), for symmetry, of the cell counts of chords (sets of opposite block edges)."""
        multiple = np.ones(self.count, dtype=np.intp)
        for k, edge in enumerate(self.edges):
            own = sum(np.array_equal(distinct(to[edge]), distinct(edge)) for to in self.images)
            if own and self.wall[k] and edge[0] != edge[-1]:
                loop = self.layout.mesh.domain.loops[self.layout.mesh.places.loop[edge[0]]]
                own = 1 + len(corners_between(loop, *self.arcs(k)[[0, -1]].tolist())[0]) % 2
            elif edge[0] != edge[-1]:
                own = 1
            multiple[self.chord[k]] = max(multiple[self.chord[k]], own)
        return multiple

    @cached_property
    def lengths(self) -> Floats:
        """Lengths (e,) of the block edges, with straight lines between nodes."""
        nodes = self.layout.mesh.nodes
        return np.array([np.hypot(*np.diff(nodes[edge], axis=0).T).sum() for edge in self.edges])

    def arcs(self, edge: int) -> Floats:
        """Return the arc lengths (n,) of the nodes of a wall edge, without a jump at the loop's start."""
        nodes, places = self.edges[edge], self.layout.mesh.places
        loop = self.layout.mesh.domain.loops[places.loop[nodes[0]]]
        steps = loop.steps(places.arc[nodes], self._ways[edge])
        return places.arc[nodes[0]] + np.concatenate([[0.0], np.cumsum(steps)])

    @cached_property
    def _ways(self) -> Floats:
        """(e,) 1 for wall edges along their loops, which have the domain on the left, -1 against them."""
        ways = np.empty(len(self.edges))
        ways[self.sides] = np.where(self.reversed, -1.0, 1.0) * (1.0, -1.0, -1.0, 1.0)
        return ways

    def _walls(self) -> Iterator[tuple[int, Loop, Floats]]:
        """Yield the number, the loop and the arc lengths (n,) of each wall edge."""
        mesh = self.layout.mesh
        for edge in np.flatnonzero(self.wall).tolist():
            yield edge, mesh.domain.loops[mesh.places.loop[self.edges[edge][0]]], self.arcs(edge)

    @cached_property
    def least(self) -> Indices:
        """Smallest permitted cell count (chords,) of each set of opposite edges; larger on curved walls."""
        least = np.full(self.count, LEAST, dtype=np.intp)
        for edge, loop, arcs in self._walls():
            ends = np.sort(arcs[[0, -1]])
            turned = float(turning_between(loop, ends[:1], ends[1:])[0])
            cells = int(np.ceil(turned / TURNING_DEG - 1e-9))
            cells = max(cells, len(corners_between(loop, *ends.tolist())[0]) + 1)  # a node at each
            least[self.chord[edge]] = max(least[self.chord[edge]], cells)
        return least

    def cells(self, counts: Indices) -> int:
        """Return the total number of cells if each edge in chord k (opposite edges) has `counts`[k] cells."""
        along = counts[self.chord[self.sides]]
        return int((along[:, 0] * along[:, 2]).sum())

    def along_loops(self, counts: Indices) -> Indices:
        """Return cells (loops,) on boundary loops from `counts`, one for each set of opposite block edges."""
        mesh = self.layout.mesh
        along = np.zeros(len(mesh.domain.loops), dtype=np.intp)
        for edge in np.flatnonzero(self.wall):
            along[mesh.places.loop[self.edges[edge][0]]] += counts[self.chord[edge]]
        return along

    def cut_off(self) -> Floats:
        """Return the area (e,) between each straight edge and the curved wall there; 0 for inner edges."""
        lost = np.zeros(len(self.edges))
        part = np.linspace(0.0, 1.0, 5)
        for edge, loop, arcs in self._walls():
            points = loop.at((arcs[:-1, None] + part * np.diff(arcs)[:, None]).ravel())
            z = (points[:, 0] + 1j * points[:, 1]).reshape(-1, len(part))
            z -= z[:, :1]
            lost[edge] = 0.5 * np.abs(times(np.conj(z[:, :-1]), z[:, 1:]).imag.sum(axis=1)).sum()
        return lost

    def bend(self, edge: int) -> float:
        """Return the wall's greatest turn, in radians, between neighbouring nodes of block edge `edge`."""
        arcs = np.sort(self.arcs(edge))
        loop = self.layout.mesh.domain.loops[self.layout.mesh.places.loop[self.edges[edge][0]]]
        return float(np.radians(turning_between(loop, arcs[:-1], arcs[1:]).max()))

    def counts_for_size(self, size: float, least: Indices | None = None) -> Indices:
        """Return numbers of cells (chords,), one for each set of opposite edges, for cells of a given size.

        The number is the rounded geometric mean of length / size over the edges of a set. `least` (chords,)
        are the smallest permitted numbers, by default the attribute `least`.
        """
        wanted = log(np.maximum(self.lengths / size, 1e-9))
        mean = np.bincount(self.chord, wanted, self.count) / np.bincount(self.chord, minlength=self.count)
        return self.rounded(exp(mean), self.least if least is None else least)

    def rounded(self, wanted: Floats, least: Indices) -> Indices:
        """Return whole cell counts near `wanted` (chords,), one for each chord (set of opposite block edges).

        They are multiples of the attribute `multiple` (chords,), and at least `least` (chords,).
        """
        times = self.multiple
        return times * np.maximum(-(-least // times), nearest_whole(wanted / times).astype(np.intp))

    def counts_for_cells(self, cells: int, least: Indices | None = None) -> Indices:
        """Return cell counts (chords,), not below `least`, that give about `cells` cells in total."""
        size = np.sqrt(self.layout.mesh.domain.area / cells)
        best = self.counts_for_size(size, least)
        for _ in range(12):
            total = self.cells(best)
            if abs(total - cells) <= 0.02 * cells:
                break
            size *= np.sqrt(total / cells)
            counts = self.counts_for_size(size, least)
            if abs(self.cells(counts) - cells) < abs(total - cells):
                best = counts
        return best


def _key(line: Indices) -> tuple[tuple[int, ...], bool]:
    """Return what tells a line of nodes, run through either way, from others, and which way this is."""
    first, second, last_but_one, last = (int(line[k]) for k in (0, 1, -2, -1))
    if (first, second) <= (last, last_but_one):
        return (first, second, last_but_one, last), False
    return (last, last_but_one, second, first), True


def _partners(layout: Layout, edges: list[Indices], numbers: dict[tuple[int, ...], int]) -> Indices:
    partner = np.full(len(edges), -1, dtype=np.intp)
    of = layout.mesh.places.partner
    if (of >= 0).any():
        for number, edge in enumerate(edges):
            if (of[edge] >= 0).all():
                partner[number] = numbers.get(_key(of[edge])[0], -1)
    return partner
