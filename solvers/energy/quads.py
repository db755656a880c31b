"""The joint optimum of a quad mesh: one functional over all cells of all blocks, one descent of all nodes.

The functional is that of `meshonet.solvers.energy.functional` in the corners of cells, with the squared
differences of log lengths over all pairs of edges that follow or face each other along a grid line, across
interfaces as inside of blocks. Nodes of interfaces and singular vertices are unknowns like any other; wall
nodes slide along their loops, in order, and edges of walls that turn by more than `ALLOWED` are held back:
angles alone are best where tips are cut off.

Folded meshes are unfolded first, with Jacobians regularised; cells that could then gain by shrinking to
points are held to their areas.

Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, ACM Trans. Graph. 40 (2021) 154 (unfolding with area
and shape).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.kernels._native import QuadDescent, line_neighbours, quad_edges
from meshonet.solvers.energy.walls import Walls, turned, walls_of

SHAPE = 0.9  # w of the functional
SMOOTHNESS = 2e-3  # its β
ALLOWED = np.radians(30.0)  # that a wall turns by within an edge
BENT = 5.0  # weight of the squares of what it turns by beyond that, over the number of cells

UNFOLDING = 0.0, 0.3  # w, and the weight of areas, while folded: angles would hold on to folds
ROUNDS = 14  # regularisations at the most
FIRST_ROUND, PER_ROUND = 80, 40  # iterations with the first, and with each other

Bools = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Optimum:
    """What `optimise` ends with."""

    mesh: QuadMesh
    valid: bool
    """Whether all corner Jacobians are positive and wall nodes are in order."""
    value: float
    """Of the functional, infinite where the mesh is not valid."""
    iterations: int


def optimise(
    mesh: QuadMesh, *, iterations: int = 60, held: Bools | None = None, aspects: Floats | None = None,
    targets: Floats | None = None, tolerance: float = 1e-4,
) -> Optimum:  # fmt: skip
    """Return the mesh with all nodes moved to where the functional is least.

    Corners (`Places.cells` > 0) and `held` nodes (n,) stay bitwise; a node with a partner is where that one
    is, moved by the domain's period, and both move freely. `aspects` (m,) are the wanted ratios of the sides
    1-2 and 0-3 of a quad to 0-1 and 3-2; `targets` (e,), for `mesh.edges`, lengths in any unit whose ratios
    those of neighbouring edges should have. It ends after so many `iterations`, or when three in a row gain
    less than a hundredth of `tolerance` of the value. Cells with no node that moves are left out.
    """
    problem = _Problem(mesh, held, aspects, targets)
    if problem.walls is None:
        return Optimum(mesh, False, np.inf, 0)
    value, done = problem.solve(iterations, 0.01 * tolerance)
    moved = problem.result()
    valid = bool(np.isfinite(value)) and smallest_jacobian(moved) > 0.0
    return Optimum(moved, valid, value if valid else np.inf, done)


def smallest_jacobian(mesh: QuadMesh) -> float:
    """Return the smallest corner Jacobian of the cells of a mesh, an area."""
    return _smallest(mesh.nodes, mesh.quads)


class _Problem:
    """A mesh in units of its cells, around the origin, as the compiled descent takes it."""

    def __init__(
        self, mesh: QuadMesh, held: Bools | None, aspects: Floats | None, targets: Floats | None
    ) -> None:
        self.mesh, n, places = mesh, len(mesh.nodes), mesh.places
        self.fixed = (places.cells > 0) if held is None else (places.cells > 0) | held
        self.slaves = np.flatnonzero((places.partner >= 0) & ~self.fixed)
        self.masters = places.partner[self.slaves]
        self.tied = np.zeros(n, dtype=bool)
        self.tied[self.slaves] = self.tied[self.masters] = True
        self.edges, self.edge_of = quad_edges(np.ascontiguousarray(mesh.quads), n)
        self.walls = walls_of(mesh, self.edges, self.edge_of, self.fixed, self.tied)
        if self.walls is None:
            return
        self.centre = 0.5 * (mesh.nodes.min(axis=0) + mesh.nodes.max(axis=0))
        area = mesh.domain.area / len(mesh.quads)
        self.unit = float(2.0 ** np.round(0.5 * np.log2(area)))
        self.cell = area / self.unit**2
        self.nodes = (self._on_walls(mesh.nodes, self.walls.arc) - self.centre) / self.unit
        self.arc = self.walls.arc / self.unit
        self.descent = self._descent(aspects, targets)

    def _on_walls(self, nodes: Floats, arc: Floats) -> Floats:
        """Return `nodes` with those that slide at arc lengths (w,) of their loops."""
        assert self.walls is not None
        nodes = nodes.copy()
        for number, loop in enumerate(self.mesh.domain.loops):
            of = (self.walls.loop == number) & ~self.fixed[self.walls.nodes]
            nodes[self.walls.nodes[of]] = loop.at(arc[of])
        return nodes

    def _descent(self, aspects: Floats | None, targets: Floats | None) -> QuadDescent:
        walls, n = self.walls, len(self.nodes)
        assert walls is not None
        slides = ~self.fixed[walls.nodes]
        inner = np.flatnonzero(~self.fixed & (self.tied | (self.mesh.places.loop < 0)))
        inner = inner[~np.isin(inner, self.slaves)] if len(self.slaves) else inner
        unknown, wall = np.full(n, -1, dtype=np.intp), np.full(n, -1, dtype=np.intp)
        unknown[inner] = 2 * np.arange(len(inner))
        of_wall = np.where(slides, 2 * len(inner) + np.cumsum(slides) - 1, -1)
        unknown[walls.nodes], wall[walls.nodes[slides]] = of_wall, np.flatnonzero(slides)
        unknown[self.slaves] = unknown[self.masters]
        moving = unknown >= 0
        movable = moving[self.mesh.quads].any(axis=1)
        quads = np.ascontiguousarray(self.mesh.quads[movable])
        ratio = np.ones(len(quads)) if aspects is None else aspects[movable]
        z = self.nodes[quads]
        across, other = z[:, 2] - z[:, 0], z[:, 3] - z[:, 1]
        area = 0.5 * np.abs(across[:, 0] * other[:, 1] - across[:, 1] * other[:, 0])
        self.area = np.maximum(area, 0.25 * self.cell)
        self.quads = quads
        line, pairs = self._lines(moving)
        target = np.zeros(len(self.edges)) if targets is None else np.log(targets)
        periodic = self.mesh.domain.periodic
        shift = (0.0, 0.0) if periodic is None else periodic.shift
        return QuadDescent(
            self.nodes,
            (quads, np.stack([ratio, 1.0 / ratio], axis=1), self.area),
            (self.edges, line, pairs, target),
            self._relief(quads, moving),
            inner,
            (np.stack([self.slaves, self.masters], axis=1), (shift[0] / self.unit, shift[1] / self.unit)),
            unknown,
            wall,
            (walls.nodes, of_wall, self.arc),
            (walls.edges, walls.round / self.unit),
            tuple(self._loop(number) for number in range(len(self.mesh.domain.loops))),
            BENT / max(len(quads), 1),
            ALLOWED,
        )

    def _loop(self, number: int) -> tuple[object, ...]:
        """Return a loop as the compiled descent takes it."""
        assert self.walls is not None
        loop = self.mesh.domain.loops[number]
        cubic, table, start, stop, pieces = loop.curve.tables
        cubic = cubic / self.unit
        cubic[0] = (loop.curve.points - self.centre) / self.unit
        numbers = self.walls.range_of(number)
        return (cubic, table / self.unit, start, stop, pieces, cubic[0, 0].copy(), turned(loop), *numbers)

    def _lines(self, moving: Bools) -> tuple[Indices, int]:
        """Return the neighbours (e, 4) of edges along grid lines, and the number of pairs."""
        partner, n = self.mesh.places.partner, len(self.nodes)
        node, edge = np.arange(n), np.arange(len(self.edges))
        if (partner >= 0).any():
            node = np.where(partner >= 0, partner, node)
            once = np.bincount(self.edge_of.ravel(), minlength=len(edge)) == 1
            twins = np.flatnonzero(once & (partner[self.edges] >= 0).all(axis=1))
            ends = np.sort(partner[self.edges[twins]], axis=1)
            keys = self.edges[:, 0] * n + self.edges[:, 1]
            at = np.minimum(np.searchsorted(keys, ends[:, 0] * n + ends[:, 1]), len(keys) - 1)
            found = (self.edges[at] == ends).all(axis=1)
            edge[twins[found]] = at[found]
        line, pairs = line_neighbours(np.ascontiguousarray(self.mesh.quads), self.edge_of, node, edge)
        still = ~moving[self.edges].any(axis=1)
        if still.any():
            own = np.arange(len(line))[:, None]
            line = np.where(still[:, None] & still[line], own, line)
            pairs = int(np.count_nonzero(line != own)) // 2
        return line, pairs

    def _relief(self, quads: Indices, moving: Bools) -> tuple[Indices, Floats]:
        """Return corners (k, 3) where the domain turns over, and the part of their angle term they give away.

        Where it takes up more than 320 degrees in two cells, as at a trailing edge, neither can be good; they
        keep sin⁴ of their angle: like a right one at best.
        """
        places, angle = self.mesh.places, np.zeros(len(self.nodes))
        for number, loop in enumerate(self.mesh.domain.loops):
            if not len(loop.corners) or loop.corner_angles.max() <= 320.0:
                continue
            at = np.flatnonzero((places.loop == number) & (places.cells > 0))
            apart = np.abs(places.arc[at, None] - loop.corner_arcs[None])
            apart = np.minimum(apart, loop.length - apart)
            nearest = apart.argmin(axis=1)
            close = apart[np.arange(len(at)), nearest] < 1e-6 * loop.length
            angle[at[close]] = loop.corner_angles[nearest[close]]
        share = angle / np.maximum(np.bincount(self.mesh.quads.ravel(), minlength=len(angle)), 1)
        cell, side = np.nonzero(((angle > 320.0) & (share > 160.0))[quads])
        corners = np.stack([quads[cell, (side + k) % 4] for k in (0, 1, 3)], axis=1)
        keeps = np.maximum(np.sin(np.radians(np.minimum(share[corners[:, 0]], 180.0))), 1e-3) ** 4
        return np.ascontiguousarray(corners), 1.0 - keeps

    def smallest(self) -> float:
        """Return the smallest corner Jacobian of cells that can move."""
        return _smallest(self.nodes, self.quads)

    def solve(self, iterations: int, gain: float) -> tuple[float, int]:
        """Unfold and descend; return the value, infinite where cells stay folded, and the iterations."""
        done, low = 0, self.smallest()
        if low <= 0.0:
            low, done = self._unfold(low)
        if low <= 0.0:
            return np.inf, done
        value, low, more = self.descent.run(SHAPE, SMOOTHNESS, 0.0, 0.0, gain, iterations, True)
        return (value if low > 0.0 else np.inf), done + more

    def _unfold(self, low: float) -> tuple[float, int]:
        """Descend with less and less regularised Jacobians until none is negative."""
        cell, done = self.cell, 0
        epsilon = max(0.3 * cell, min(2.0 * abs(low), 3.0 * cell))
        shape, size = UNFOLDING
        for number in range(ROUNDS):
            most = PER_ROUND if number else FIRST_ROUND
            _, low, more = self.descent.run(shape, SMOOTHNESS, epsilon, size, 1e-5, most, True)
            done += more
            if low > 0.0:
                break
            epsilon *= 0.5
            if number < ROUNDS // 2:
                epsilon = min(epsilon, 2.0 * abs(low) + 1e-3 * cell)
            epsilon = max(epsilon, 1e-4 * cell)
        return low, done

    def result(self) -> QuadMesh:
        """Return the mesh where the descent is."""
        assert self.walls is not None
        arc = self.mesh.places.arc.copy()
        lengths = np.array([loop.length for loop in self.mesh.domain.loops])
        slides = ~self.fixed[self.walls.nodes]
        own = self.walls.nodes[slides]
        arc[own] = np.mod(self.arc[slides] * self.unit, lengths[self.walls.loop[slides]])
        nodes = self.nodes * self.unit + self.centre
        nodes[self.fixed] = self.mesh.nodes[self.fixed]
        nodes = self._on_walls(nodes, arc[self.walls.nodes])
        periodic = self.mesh.domain.periodic
        if periodic is not None:
            nodes[self.slaves] = nodes[self.masters] + np.array(periodic.shift)
        return self.mesh.with_nodes(nodes, arc)


def _smallest(nodes: Floats, quads: Indices) -> float:
    z = nodes[quads]
    u, v = np.roll(z, -1, axis=1) - z, np.roll(z, 1, axis=1) - z
    return float((u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]).min(initial=np.inf))
