"""The blocks of strips of layers under the nodes of their fronts, and of the corners where strips meet.

::

    strip | Q - - - front       a corner's block [i, j]: P at [0, 0], south along the wall that leaves the
    ------+--------             corner, west along the one that arrives there, Q at [-1, -1]
          |
    P ----+ b -----
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.algebraic.tfi import interpolate, parameters
from meshonet.solvers.blocking.attach import beside, loop_nodes
from meshonet.solvers.blocking.cut_loop import CutLoop
from meshonet.solvers.blocking.layer_law import layer_arcs
from meshonet.solvers.blocking.layer_rows import LayerSettings, heights_inside, layer_lines
from meshonet.solvers.blocking.strips import Strip

Cut = CutLoop[Strip]


def attach_strips(
    layout: Layout, domain: Domain, number: int, cut: Cut, rows: Sequence[int], settings: LayerSettings
) -> tuple[Layout, tuple[int, ...]]:
    """Return a layout with the layers of a cut loop, and the numbers of the blocks in its corners.

    `rows` are those of each strip; `number` is that of the loop, the cut one in the layout's domain and the
    whole one in `domain`.
    """
    return _Attached(layout, domain, number, cut, settings).whole(rows)


class _Attached:
    def __init__(
        self, layout: Layout, domain: Domain, number: int, cut: Cut, settings: LayerSettings
    ) -> None:
        self.layout, self.mesh, self.domain = layout, layout.mesh, domain
        self.number, self.cut, self.settings = number, cut, settings
        old = self.mesh.places
        self.heights = np.zeros(len(self.mesh.nodes))
        self.heights[loop_nodes(self.mesh, number)] = heights_inside(layout, number)
        self.fronts = [cut.front_nodes(self.mesh, number, k) for k in range(len(cut.layers))]
        self.own = replace(old, loop=old.loop.copy(), arc=old.arc.copy(), cells=old.cells.copy())
        self.nodes = [self.mesh.nodes.copy()]
        self.places = [self.own]
        self.count = len(self.mesh.nodes)

    def whole(self, rows: Sequence[int]) -> tuple[Layout, tuple[int, ...]]:
        """Return the layout and its corner blocks."""
        self._rest()
        blocks, layers = list(self.layout.blocks), dict(self.layout.layers)
        tables = [self._strip(k, rows[k]) for k in range(len(rows))]
        for k, table in enumerate(tables):
            order = self.fronts[k][0]
            closed = bool(order[0] == order[-1])
            position = np.full(len(self.mesh.nodes), -1, dtype=np.intp)
            position[order[: len(order) - closed]] = np.arange(len(order) - closed)
            for side in beside(self.layout.blocks, position, len(order) - 1 if closed else 1 << 40):
                layers[len(blocks)] = rows[k]
                blocks.append(table[side[0] + np.arange(len(side))][:, ::-1])
        corners = []
        for k, strip in enumerate(self.cut.layers):
            if strip.joined[1]:
                corners.append(len(blocks))
                blocks.append(self._corner(strip, tables[k][-1], tables[(k + 1) % len(tables)][0]))
        joined = Places(*(np.concatenate([vars(p)[name] for p in self.places]) for name in vars(self.own)))
        mesh = QuadMesh(self.domain, np.concatenate(self.nodes), lattice_quads(blocks), joined)
        layout = Layout(mesh, tuple(blocks), layers)
        return with_corners(layout, corners, self.settings), tuple(corners)

    def _rest(self) -> None:
        """Put nodes of the cut loop on the whole one, those of fronts inside."""
        own, nodes = self.own, self.nodes[0]
        on_fronts = np.zeros(len(nodes), dtype=bool)
        for order, _ in self.fronts:
            on_fronts[order] = True
        rest = np.flatnonzero((self.mesh.places.loop == self.number) & ~on_fronts)
        own.arc[rest] = self.cut.outer_arcs(own.arc[rest])
        nodes[rest] = self.cut.outer.at(own.arc[rest])
        own.loop[on_fronts], own.arc[on_fronts], own.cells[on_fronts] = -1, 0.0, 0
        for (order, _), strip in zip(self.fronts, self.cut.layers, strict=True):
            for side in (0, 1):
                if not strip.joined[side]:
                    node = order[-side]
                    own.loop[node] = self.number
                    own.arc[node] = np.mod(strip.ends[side], self.cut.outer.length)

    def _strip(self, k: int, rows: int) -> Indices:
        """Add the nodes of a strip; return their numbers (n, rows + 1) from the front to the wall."""
        strip, (order, index) = self.cut.layers[k], self.fronts[k]
        loop = self.cut.outer
        inner = self.heights[order]
        inner[[0, -1]] = inner[[1, -2]]  # at corners of the new loop, what runs along it was measured
        columns, starts = strip.columns(index)
        lines = layer_lines(columns, self.mesh.nodes[order], inner, rows, self.settings)[:, ::-1]
        n = len(order)
        places = Places.inside(n * rows)
        wall = np.arange(n) * rows + rows - 1
        places.loop[wall], places.arc[wall] = self.number, starts
        for arc, cells in zip(loop.corner_arcs, loop.corner_cells, strict=True):
            places.cells[wall[starts == arc]] = cells
        for side, corner, way in zip((0, 1), strip.stretch.span(loop), (-1.0, 1.0), strict=True):
            if strip.joined[side]:
                continue
            line = lines[-side]
            away = np.cumsum(np.hypot(*np.diff(line[::-1], axis=0).T))[:-1] * way
            at = np.mod(corner + away * strip.heights[side] / abs(_length(line)), loop.length)[::-1]
            new = (np.arange(rows - 1) + (n - 1) * rows) if side else np.arange(rows - 1)
            places.loop[new], places.arc[new] = self.number, at
            line[1:-1] = loop.at(at)
        table = np.empty((n, rows + 1), dtype=np.intp)
        table[:, 0] = order
        table[:, 1:] = self._added(lines[:, 1:].reshape(-1, 2), places).reshape(n, rows)
        return table

    def _corner(self, strip: Strip, arriving: Indices, leaving: Indices) -> Indices:
        """Add the nodes of a corner's block between the last column of a strip and the first of the next.

        Both from front to wall. The nodes get their coordinates later.
        """
        n, m = len(arriving), len(leaving)
        block = np.full((n, m), -1, dtype=np.intp)
        block[:, -1], block[-1] = arriving[::-1], leaving[::-1]
        places = Places.inside((n - 1) * (m - 1))
        number = np.arange(len(places.loop)).reshape(n - 1, m - 1)
        places.loop[number[0]] = places.loop[number[:, 0]] = self.number
        places.cells[0] = 1
        places.arc[number[0]] = places.arc[number[:, 0]] = self.cut.outer.corner_arcs[strip.stretch.last]
        block[:-1, :-1] = self._added(np.zeros((len(places.loop), 2)), places).reshape(n - 1, m - 1)
        return block

    def _added(self, nodes: Floats, places: Places) -> Indices:
        """Add nodes and return their numbers."""
        new = self.count + np.arange(len(nodes))
        self.nodes.append(nodes)
        self.places.append(places)
        self.count += len(nodes)
        return new


def _length(line: Floats) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def with_corners(layout: Layout, corners: Sequence[int], settings: LayerSettings) -> Layout:
    """Return the layout with the nodes of blocks in corners placed anew, between the layers that meet there.

    Along both walls they have the layers of the other one.
    """
    mesh = layout.mesh
    nodes, arcs = mesh.nodes.copy(), mesh.places.arc.copy()
    for number in corners:
        block = layout.blocks[number]
        loop = mesh.domain.loops[mesh.places.loop[block[0, 0]]]
        corner = float(arcs[block[0, 0]])
        for wall, beside_it, way in ((block[:, 0], block[:, -1], 1.0), (block[0], block[-1], -1.0)):
            length = np.mod(way * (arcs[wall[-1]] - corner), loop.length)
            column = np.hypot(*np.diff(nodes[beside_it], axis=0).T)
            last = length * column[-1] / column.sum()
            away = layer_arcs(
                np.array([length]), settings.first, np.array([last]), len(wall) - 1, settings.constant,
                settings.growth,
            )[0]  # fmt: skip
            arcs[wall[1:-1]] = np.mod(corner + way * away[1:-1], loop.length)
            nodes[wall[:-1]] = loop.at(arcs[wall[:-1]])
        nodes[block] = _between(nodes[block], settings.first)
    return replace(layout, mesh=mesh.with_nodes(nodes, arcs))


def _between(nodes: Floats, first: float) -> Floats:
    """Return the nodes (n, m, 2) of a corner's block between its sides, first cells as high as at walls."""
    sides = nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1]
    filled = np.empty((2, *nodes.shape[:2]))
    interpolate(filled[0], filled[1], sides, parameters(sides, "arclength"))
    block = filled.transpose(1, 2, 0)
    block[:, 0], block[:, -1], block[0], block[-1] = sides
    for wall in (block[1:-1], block.transpose(1, 0, 2)[1:-1]):
        step = wall[:, 1] - wall[:, 0]
        wall[:, 1] = wall[:, 0] + step * (first / np.hypot(*step.T))[:, None]
    block[1, 1] = block[1, 0] + block[0, 1] - block[0, 0]
    return np.asarray(block)
