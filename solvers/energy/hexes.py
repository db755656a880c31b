"""The joint optimum of hexahedra in blocks: one functional over all cells, one descent of all nodes.

The functional (``kernels/hexes/energy.c``) is that of `meshonet.solvers.volumes.variational` with lengths of
cells and edges that are wanted instead of one length a direction, so that layers keep theirs, and with the
squared differences of log lengths taken across interfaces as inside of blocks. Interface nodes and singular
edges are unknowns like any other.

Folded meshes are unfolded first, with Jacobians regularised, less and less of it.

Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov, ACM Trans. Graph. 40 (2021) 154 (unfolding).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.threads import MANY_VISITS, threads_for
from meshonet.geometry.volume.hex_mesh import Bools, HexMesh, corners_of
from meshonet.kernels._native import HexDescent
from meshonet.solvers.energy.hex_bricks import Bricks, Targets, bricks_of, cell_lengths, forces_of

SHAPE = 0.9  # w of the functional
SMOOTHNESS = 2e-3  # its β

UNFOLDING = 0.02, 0.1  # w, and the weight of volumes, while folded: angles would hold on to folds
ROUNDS = 20  # regularisations at the most
PER_ROUND = 15  # iterations with each
RAMP = ((0.02, 20), (0.3, 10))  # w and iterations before the functional itself, where a mesh is nearly folded
NEARLY = 0.05  # smallest Jacobian of a cell of unit lengths up to which it is
RENEWAL = 15  # iterations with a preconditioner


@dataclass(frozen=True, eq=False)
class Slides:
    """Nodes that move in planes or along lines: their numbers (k,) and projections (k, 3, 3)."""

    nodes: Indices
    projections: Floats

    @classmethod
    def none(cls) -> Slides:
        """Return those of a mesh none of whose nodes do."""
        return cls(np.empty(0, dtype=np.intp), np.empty((0, 3, 3)))


@dataclass(frozen=True, eq=False)
class HexOptimum:
    """What `optimise` ends with."""

    nodes: Floats
    """(n, 3), those that did not move bitwise as they were."""
    smallest: float
    """Jacobian of a corner of cells that move, as a part of the volume of the cell that is wanted."""
    value: float
    iterations: int

    @property
    def valid(self) -> bool:
        """Whether no cell that could move is folded."""
        return self.smallest > 0.0


class HexProblem:
    """The descent of a mesh of which nodes `moves` (n,) are free."""

    def __init__(self, mesh: HexMesh, moves: Bools, targets: Targets, slides: Slides | None = None) -> None:
        self.mesh, self.moves = mesh, moves
        self.slides = Slides.none() if slides is None else slides
        self.nodes = np.ascontiguousarray(mesh.nodes).copy()
        bricks = bricks_of(mesh, moves, targets)
        self.descent = self._descent(bricks, targets)

    def _descent(self, bricks: Bricks, targets: Targets) -> HexDescent:
        free, start, place = forces_of(bricks, self.moves)
        rank = np.cumsum(self.moves) - 1
        sliding = self.moves[self.slides.nodes]
        unknowns = np.ascontiguousarray(rank[self.slides.nodes[sliding]], dtype=np.intp)
        projections = np.ascontiguousarray(self.slides.projections[sliding].reshape(-1, 9))
        sizes = _sizes(self.mesh, targets)[free]
        return HexDescent(
            self.nodes, bricks.bricks, bricks.lattices, self.moves, bricks.inverse, bricks.targets,
            (free, start, place, 1.0 / sizes), (unknowns, projections), float(self.mesh.cells),
            threads_for(len(self.nodes), MANY_VISITS),
        )  # fmt: skip

    def result(self) -> Floats:
        """Return the nodes (n, 3) where the descent is; those that slide exactly where they may be."""
        nodes, before, at = self.nodes.copy(), self.mesh.nodes, self.slides.nodes
        moved = (self.slides.projections * (nodes[at] - before[at])[:, None]).sum(axis=2)
        nodes[at] = before[at] + moved
        nodes[~self.moves] = before[~self.moves]
        return nodes


def _sizes(mesh: HexMesh, targets: Targets) -> Floats:
    """Return the mean wanted length (n,) of the sides of the cells at each node."""
    total, count = np.zeros(len(mesh.nodes)), np.zeros(len(mesh.nodes))
    for block, wanted in zip(mesh.blocks, targets, strict=True):
        mean = cell_lengths(wanted).mean(axis=0)
        for corner in corners_of(block):
            at = corner.ravel()
            total += np.bincount(at, mean.ravel(), len(total))
            count += np.bincount(at, minlength=len(total))
    return total / np.maximum(count, 1)


def optimise(
    mesh: HexMesh, moves: Bools, targets: Targets, *, slides: Slides | None = None, iterations: int = 60,
    tolerance: float = 1e-5,
) -> HexOptimum:  # fmt: skip
    """Return the nodes of `mesh`, of which `moves` (n,) are free, where the functional is least.

    It ends after so many `iterations`, not counting those of unfolding, or when two in a row gain less than
    `tolerance` of the value. Cells with no node that moves are left out.
    """
    problem = HexProblem(mesh, moves, targets, slides)
    low, value, done = unfold(problem)
    if low <= 0.0:
        return HexOptimum(problem.result(), low, np.inf, done)
    descent = problem.descent
    for shape, most in RAMP if low < NEARLY else ():
        descent.weigh(shape, SMOOTHNESS)
        done += descent.run(1e-4, min(most, iterations), RENEWAL)[2]
    descent.weigh(SHAPE, SMOOTHNESS)
    value, low, more = descent.run(tolerance, iterations, RENEWAL)
    return HexOptimum(problem.result(), low, value, done + more)


def unfold(problem: HexProblem) -> tuple[float, float, int]:
    """Descend with less and less regularised Jacobians until none is negative.

    Return the smallest Jacobian, the value and the iterations.
    """
    descent, done, value = problem.descent, 0, np.inf
    shape, size = UNFOLDING
    descent.weigh(shape, SMOOTHNESS, 1.0, size)
    _, low, _ = descent.run(0.0, 0, RENEWAL)
    for number in range(ROUNDS):
        if low > 0.0:
            break
        epsilon = np.sqrt(1e-4 + 0.04 * low * low) * (1.0 if number < ROUNDS // 2 else 0.3)
        descent.weigh(shape, SMOOTHNESS, float(epsilon), size)
        value, low, more = descent.run(1e-5, PER_ROUND, PER_ROUND)
        done += more
    return low, value, done
