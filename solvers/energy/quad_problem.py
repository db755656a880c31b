"""A quad mesh in the form of the compiled minimisation: unknowns, constraints and pairs of edges."""

import math
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, cross2
from meshonet.geometry.elementary import arctan2, log, sin
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.kernels._native import QuadDescent, line_neighbours
from meshonet.solvers.energy.walls import Walls, turned

ALLOWED = np.radians(30.0)  # that a wall turns by within an edge
BENT = 5.0  # weight of the squares of what it turns by beyond that, over the number of cells
MANY = 1000  # cells: with more, what a tip cut off wins grows with their number, and so does that weight
SPREAD = 6  # rounds of averaging of the areas of neighbouring cells
SPOILT = 0.1  # fraction of folded cells above which the areas of cells are no guide

SHARP = 320.0  # degrees: where the domain takes up more, angles are relieved
WIDE = 160.0  # degrees of a single cell from which on they are


@dataclass(frozen=True, eq=False)
class Unknowns:
    """Masks and indices of fixed nodes, and of nodes that are periodic images of other nodes."""

    fixed: Bools
    images: Indices
    originals: Indices
    tied: Bools  # (n,) mask of images and their originals


def unknowns_of(mesh: QuadMesh, held: Bools | None) -> Unknowns:
    """Return fixed nodes and periodic images of a mesh; corners and nodes in the mask `held` are fixed."""
    places = mesh.places
    fixed = (places.cells > 0) if held is None else (places.cells > 0) | held
    images = np.flatnonzero((places.partner >= 0) & ~fixed)
    originals = places.partner[images]
    tied = np.zeros(len(mesh.nodes), dtype=bool)
    tied[images] = tied[originals] = True
    return Unknowns(fixed, images, originals, tied)


def smallest_jacobian(nodes: Floats, quads: Indices, areas: Floats | None = None) -> float:
    """Return the smallest corner Jacobian of cells `quads` (m, 4), divided by their `areas` (m,) if given."""
    least = smallest_jacobians(nodes, quads)
    return float((least if areas is None else least / areas).min(initial=np.inf))


class Problem:
    """Minimisation of a functional of cell shapes and edge lengths over the nodes of a quadrilateral mesh."""

    cell: float  # mean area of a cell in scaled units
    descent: QuadDescent

    def __init__(
        self, mesh: QuadMesh, unknowns: Unknowns, walls: Walls, aspects: Floats | None,
        targets: Floats | None, turning: float = ALLOWED,
    ) -> None:  # fmt: skip
        self.mesh, self.walls, self.unknowns = mesh, walls, unknowns
        self.centre = 0.5 * (mesh.nodes.min(axis=0) + mesh.nodes.max(axis=0))
        area = mesh.domain.area / len(mesh.quads)
        self.unit = 2.0 ** round(0.5 * math.log2(area))
        self.cell = area / self.unit**2
        self.slides = ~unknowns.fixed[walls.nodes]
        self.nodes = (self._on_walls(mesh.nodes, walls.arc) - self.centre) / self.unit
        self.arc = walls.arc / self.unit
        self._number()
        self.descent = self._descent(aspects, targets, turning)

    def take(self, mesh: QuadMesh) -> None:
        """Start again with a mesh that has the same cells and other positions of inner nodes.

        All wall nodes must be fixed, at the same positions as before.
        """
        self.mesh = mesh
        self.nodes[:] = (mesh.nodes - self.centre) / self.unit
        self.areas[:] = self._areas()

    def _number(self) -> None:
        """Assign numbers to the unknowns: coordinates of inner nodes, then arc lengths of wall nodes."""
        n, known, walls = len(self.nodes), self.unknowns, self.walls
        free = ~known.fixed & (known.tied | (self.mesh.places.loop < 0))
        free[known.images] = False
        self.inner = np.flatnonzero(free)
        self.unknown, self.wall = np.full(n, -1, dtype=np.intp), np.full(n, -1, dtype=np.intp)
        self.unknown[self.inner] = 2 * np.arange(len(self.inner))
        self.of_wall = np.where(self.slides, 2 * len(self.inner) + np.cumsum(self.slides) - 1, -1)
        self.unknown[walls.nodes] = self.of_wall
        self.wall[walls.nodes[self.slides]] = np.flatnonzero(self.slides)
        self.unknown[known.images] = self.unknown[known.originals]
        self.moves = self.unknown >= 0

    def _descent(self, aspects: Floats | None, targets: Floats | None, turning: float) -> QuadDescent:
        known, walls = self.unknowns, self.walls
        movable = self.moves[self.mesh.quads].any(axis=1)
        self.quads = np.ascontiguousarray(self.mesh.quads[movable])
        ratio = np.ones(len(self.quads)) if aspects is None else aspects[movable]
        self.areas = self._areas()
        line, pairs = self._lines()
        target = np.zeros(len(line)) if targets is None else log(targets)
        return QuadDescent(
            self.nodes, (self.quads, np.stack([ratio, 1.0 / ratio], axis=1), self.areas),
            (self.mesh.edges, line, pairs, target), self._relief(), self.inner,
            (np.stack([known.images, known.originals], axis=1), self.mesh.shifts(known.images) / self.unit),
            self.unknown, self.wall, (walls.nodes, self.of_wall, self.arc),
            (walls.edges, walls.round / self.unit),
            tuple(self._loop(number) for number in range(len(self.mesh.domain.loops))),
            BENT * (ALLOWED / turning) ** 2 / min(max(len(self.quads), 1), MANY), turning, self._crossed(),
        )  # fmt: skip

    def _crossed(self) -> Indices:
        """Return pairs (k, 2) of edges at irregular inner nodes, with exactly one other edge between."""
        mesh, parts = self.mesh, [np.empty((0, 2), dtype=np.intp)]
        irregular = mesh.irregular & ~mesh.wall_nodes & self.moves
        near = np.flatnonzero(irregular[mesh.edges].any(axis=1))
        for vertex in np.flatnonzero(irregular).tolist():
            edges = near[(mesh.edges[near] == vertex).any(axis=1)]
            away = mesh.nodes[mesh.edges[edges].sum(axis=1) - vertex] - mesh.nodes[vertex]
            edges = edges[np.argsort(arctan2(away[:, 1], away[:, 0]), kind="stable")]
            parts.append(np.stack([edges, np.roll(edges, -2)], axis=1))
        return np.ascontiguousarray(np.concatenate(parts))

    def _areas(self) -> Floats:
        """Return the areas (m,) of cells, or, if a cell is folded, their target areas for untangling.

        The target is the larger of the area and the mean area of the cells around, or a smallest area.
        """
        z, n = self.nodes[self.quads], len(self.nodes)
        across, other = z[:, 2] - z[:, 0], z[:, 3] - z[:, 1]
        signed = 0.5 * cross2(across, other)
        area = np.abs(signed)
        if smallest_jacobian(self.nodes, self.quads) > 0.0:
            return area
        flat, count = self.quads.ravel(), np.maximum(np.bincount(self.quads.ravel(), minlength=n), 1)
        around = area
        for _ in range(SPREAD):
            around = (np.bincount(flat, np.repeat(around, 4), n) / count)[self.quads].mean(axis=1)
        spoilt = np.count_nonzero(signed <= 0) > SPOILT * len(signed)
        least = 0.25 * self.cell if spoilt else 1e-9 * self.cell
        return np.maximum(np.maximum(area, around), least)

    def _loop(self, number: int) -> tuple[object, ...]:
        loop = self.mesh.domain.loops[number]
        cubic, table, start, stop, pieces = loop.curve.tables
        cubic = cubic / self.unit
        cubic[0] = (loop.curve.points - self.centre) / self.unit
        numbers = self.walls.range_of(number)
        return (cubic, table / self.unit, start, stop, pieces, cubic[0, 0].copy(), turned(loop), *numbers)

    def _lines(self) -> tuple[Indices, int]:
        """Return the neighbours (e, 4) of edges along grid lines, and the number of pairs."""
        mesh, partner, n = self.mesh, self.mesh.places.partner, len(self.nodes)
        edges, node, edge = mesh.edges, np.arange(n), np.arange(len(mesh.edges))
        if (partner >= 0).any():
            node = np.where(partner >= 0, partner, node)
            twins = np.flatnonzero(mesh.on_wall & (partner[edges] >= 0).all(axis=1))
            ends = np.sort(partner[edges[twins]], axis=1)
            keys = edges[:, 0] * n + edges[:, 1]
            at = np.minimum(np.searchsorted(keys, ends[:, 0] * n + ends[:, 1]), len(keys) - 1)
            exists = (edges[at] == ends).all(axis=1)
            edge[twins[exists]] = at[exists]
        line, pairs = line_neighbours(np.ascontiguousarray(mesh.quads), mesh.edge_of, node, edge)
        still = np.asarray(~self.moves[edges].any(axis=1))
        if still.any():
            own = np.arange(len(line))[:, None]
            line = np.where(still[:, None] & still[line], own, line)
            pairs = int(np.count_nonzero(line != own)) // 2
        return line, pairs

    def _relief(self) -> tuple[Indices, Floats]:
        """Return corners (k, 3) with angles above 320 degrees, and the removed part of their angle term.

        The factor sin⁴ of half the angle remains, for corners that two cells share.
        """
        places, angle = self.mesh.places, np.zeros(len(self.nodes))
        for number, loop in enumerate(self.mesh.domain.loops):
            if not len(loop.corners) or loop.corner_angles.max() <= SHARP:
                continue
            at = np.flatnonzero((places.loop == number) & (places.cells > 0))
            apart = np.abs(places.arc[at, None] - loop.corner_arcs[None])
            apart = np.minimum(apart, loop.length - apart)
            nearest = apart.argmin(axis=1)
            close = apart[np.arange(len(at)), nearest] < 1e-6 * loop.length
            angle[at[close]] = loop.corner_angles[nearest[close]]
        share = angle / np.maximum(np.bincount(self.mesh.quads.ravel(), minlength=len(angle)), 1)
        cell, side = np.nonzero(((angle > SHARP) & (share > WIDE))[self.quads])
        corners = np.stack([self.quads[cell, (side + k) % 4] for k in (0, 1, 3)], axis=1)
        keeps = np.maximum(sin(np.radians(np.minimum(share[corners[:, 0]], 180.0))), 1e-3) ** 2
        return np.ascontiguousarray(corners), 1.0 - keeps**2

    def _on_walls(self, nodes: Floats, arc: Floats) -> Floats:
        """Return `nodes` with sliding nodes at arc lengths (w,) of their loops."""
        nodes, walls = nodes.copy(), self.walls
        nodes[walls.nodes[self.slides]] = self.mesh.domain.at(walls.loop[self.slides], arc[self.slides])
        return nodes

    def smallest(self) -> float:
        """Return the smallest corner Jacobian of cells with free nodes, relative to the cell's area."""
        return smallest_jacobian(self.nodes, self.quads, self.areas)

    def result(self) -> QuadMesh:
        """Return the mesh with the current nodes."""
        known, walls = self.unknowns, self.walls
        arc = self.mesh.places.arc.copy()
        lengths = self.mesh.domain.lengths
        own = walls.nodes[self.slides]
        arc[own] = np.mod(self.arc[self.slides] * self.unit, lengths[walls.loop[self.slides]])
        nodes = self.nodes * self.unit + self.centre
        nodes[known.fixed] = self.mesh.nodes[known.fixed]
        nodes = self._on_walls(nodes, arc[walls.nodes])
        if len(known.images):
            nodes[known.images] = nodes[known.originals] + self.mesh.shifts(known.images)
        return self.mesh.with_nodes(nodes, arc)
