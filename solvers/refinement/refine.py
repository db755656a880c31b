"""Changes the numbers of cells of a layout, by splines along its edges and through its blocks."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.block import Block, Range
from meshonet.geometry.blocks.families import joins_whole_sides
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.wall_turning import corners_between
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.from_grid import layout_of
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.solvers.algebraic.resample import quad
from meshonet.solvers.algebraic.resample.spline import spline_matrix
from meshonet.solvers.refinement.chords import Chords

_FINER = 8  # points a cell, between which nodes at given places lie on straight lines


def refine(
    layout: Layout, counts: Indices, chords: Chords | None = None, places: Sequence[Floats] | None = None
) -> Layout:
    """Return the layout with new numbers of cells along the edges of its blocks.

    `counts` (chords,) has a number for each set of opposite edges. `places` has, for each edge, the positions
    (cells + 1,) of new nodes as fractional indices of old nodes; None: equal steps. If a corner of the domain
    is inside an edge, the nearest new node moves there. Layers are not preserved.
    """
    chords = chords or Chords.of(layout)
    return _Refined(chords, counts, places).layout


def multiplied(layout: Layout, times: int) -> Layout:
    """Return the layout with each cell divided into `times` x `times` cells; old nodes are bitwise kept."""
    chords = Chords.of(layout)
    return refine(layout, chords.counts * times, chords)


def refined(grid: Grid, times: int) -> Grid:
    """Return `grid` with each cell divided into `times` x `times` cells; its nodes are kept.

    Raises InputError as `layout_of`, and if a connection covers only a part of a side.
    """
    for each in grid.connections:
        if not joins_whole_sides(grid, each):
            problem = f"{each} joins parts of sides, and blocks are refined side by side"
            raise InputError(problem, "split the blocks there", parameter="refine")
    layout = multiplied(layout_of(grid), times)
    nodes = layout.mesh.nodes

    def scaled(span: Range) -> Range:
        return tuple((start * times, stop * times) for start, stop in span)

    patches = tuple(replace(p, start=p.start * times, stop=p.stop * times) for p in grid.patches)
    connections = tuple(
        replace(each, range=scaled(each.range), donor_range=scaled(each.donor_range))
        for each in grid.connections
    )
    blocks = tuple(Block(nodes[block]) for block in layout.blocks)
    return replace(grid, blocks=blocks, patches=patches, connections=connections)


class _Refined:
    """New nodes in the order vertices, edges, blocks."""

    def __init__(self, chords: Chords, counts: Indices, places: Sequence[Floats] | None) -> None:
        self.chords, self.old, self.at = chords, chords.layout.mesh, places
        self.cells = counts[chords.chord]
        vertices = chords.layout.vertices
        self.number = np.full(len(self.old.nodes), -1, dtype=np.intp)
        self.number[vertices] = np.arange(len(vertices))
        inner = self.cells - 1
        self.first = len(vertices) + np.concatenate([[0], np.cumsum(inner)])
        self.nodes = np.empty((int(self.first[-1]), 2))
        self.nodes[: len(vertices)] = self.old.nodes[vertices]
        self.places = self.old.places.take(vertices).and_then(Places.inside(int(inner.sum())))
        self.edges = [self._edge(k) for k in range(len(chords.edges))]
        self._set_partners()
        self.layout = self._filled()

    def _edge(self, k: int) -> Indices:
        old, own = self.chords.edges[k], self.number
        inner = np.arange(self.first[k], self.first[k + 1])
        new = np.concatenate([own[old[:1]], inner, own[old[-1:]]])
        at = np.linspace(0.0, len(old) - 1.0, len(new)) if self.at is None else self.at[k]
        if self.chords.wall[k]:
            number = int(self.old.places.loop[old[0]])
            loop = self.old.domain.loops[number]
            before = self.chords.arcs(k)
            arcs, corners = _wall_arcs(loop, before, at)
            self.places.loop[inner] = number
            self.places.arc[inner] = np.mod(arcs[1:-1], loop.length)
            self.places.cells[inner] = corners[1:-1]
            self.nodes[inner] = loop.at(arcs[1:-1])
        else:
            ring = old[0] == old[-1] and len(old) > 3
            finer = 1 if self.at is None else _FINER
            spline = spline_matrix(len(old), finer * (len(new) - 1) + 1, bool(ring))
            line = product(spline, self.old.nodes[old])
            if self.at is not None:
                dense = np.linspace(0.0, len(old) - 1.0, len(line))
                line = np.stack([np.interp(at, dense, line[:, axis]) for axis in (0, 1)], axis=1)
            self.nodes[inner] = line[1:-1]
        whole, rest = divmod(len(new) - 1, len(old) - 1)
        if not rest and self.at is None:  # nodes that are not moved to a corner stay bitwise the same
            stay = np.ones(len(old), dtype=bool)
            if self.chords.wall[k]:
                stay = np.abs(arcs[::whole] - before) <= 1e-9 * loop.length
            self.nodes[new[::whole][stay]] = self.old.nodes[old[stay]]
        return new

    def _set_partners(self) -> None:
        of, domain = self.old.places.partner, self.old.domain
        if not (of >= 0).any() or not domain.periodic:
            return
        kept = self.chords.layout.vertices
        has = of[kept] >= 0
        self.places.partner[np.flatnonzero(has)] = self.number[of[kept[has]]]
        for k in np.flatnonzero(self.chords.partner >= 0):
            beyond = self.edges[self.chords.partner[k]]
            same = (
                of[self.chords.edges[k][:2]].tolist()
                == self.chords.edges[self.chords.partner[k]][:2].tolist()
            )
            self.places.partner[self.edges[k]] = beyond if same else beyond[::-1]
        moved = np.flatnonzero(self.places.partner >= 0)
        known = QuadMesh(domain, self.nodes, np.empty((0, 4), dtype=np.intp), self.places)
        self.nodes[moved] = self.nodes[self.places.partner[moved]] + known.shifts(moved)

    def _filled(self) -> Layout:
        lattices, parts, count = [], [self.nodes], len(self.nodes)
        for block, sides, turned in zip(
            self.chords.layout.blocks, self.chords.sides, self.chords.reversed, strict=True
        ):
            four = [
                self.edges[side][::-1] if back else self.edges[side]
                for side, back in zip(sides.tolist(), turned.tolist(), strict=True)
            ]
            inside = self._inside(block, four)
            lattice = np.empty((len(four[0]), len(four[2])), dtype=np.intp)
            lattice[:, 0], lattice[:, -1], lattice[0], lattice[-1] = four
            lattice[1:-1, 1:-1] = count + np.arange(len(inside)).reshape(lattice[1:-1, 1:-1].shape)
            parts.append(inside)
            lattices.append(lattice)
            count += len(inside)
        places = self.places.and_then(Places.inside(count - len(self.nodes)))
        quads = lattice_quads(lattices)
        mesh = QuadMesh(self.old.domain, np.concatenate(parts), quads, places)
        return Layout(mesh, tuple(lattices))

    def _inside(self, block: Indices, four: list[Indices]) -> Floats:
        if min(len(four[0]), len(four[2])) < 3:
            return np.empty((0, 2))
        coarse = np.ascontiguousarray(self.old.nodes[block].transpose(2, 0, 1))[None]
        south, north, west, east = (np.ascontiguousarray(self.nodes[edge].T)[None] for edge in four)
        fine = quad.refine_quad(coarse, (south, north, west, east))[0]
        strides = [divmod(n - 1, m - 1) for n, m in zip(fine.shape[1:], block.shape, strict=True)]
        if not strides[0][1] and not strides[1][1] and self.at is None:
            fine[:, :: strides[0][0], :: strides[1][0]] = coarse[0]
        return np.asarray(fine[:, 1:-1, 1:-1].reshape(2, -1).T)


def _wall_arcs(loop: Loop, arcs: Floats, at: Floats) -> tuple[Floats, Indices]:
    """Return arc lengths (m,) at numbers `at` (m,) of the places `arcs` (n,), and the cells at corners.

    Nodes nearest to the corners of the loop are put there.
    """
    n, count, way = len(arcs), len(at), 1.0 if arcs[-1] > arcs[0] else -1.0
    new = monotone_cubic(np.arange(float(n)), way * arcs, at)  # rising, whichever way the edge runs
    new[[0, -1]] = way * arcs[[0, -1]]
    cells = np.zeros(count, dtype=np.intp)
    corners, wanted = corners_between(loop, float(arcs[0]), float(arcs[-1]))
    if len(corners):
        nearest = [int(np.argmin(np.abs(new - way * corner))) for corner in corners]
        for k in range(len(nearest)):  # each a node of its own, in order
            low = 1 if k == 0 else nearest[k - 1] + 1
            nearest[k] = min(max(nearest[k], low), count - 1 - len(nearest) + k)
        anchors = [0, *nearest, count - 1]
        to = way * np.concatenate([arcs[:1], corners, arcs[-1:]])
        new = np.interp(new, new[anchors], to)
        new[anchors] = to
        cells[nearest] = wanted
    return way * new, cells
