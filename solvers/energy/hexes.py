"""The joint optimum of hexahedra in blocks: one functional over all cells, one descent of all nodes.

Interface nodes and singular edges are unknowns like any other. Folded meshes are unfolded first, with
Jacobians regularised, less and less of it; meshes that are nearly folded are opened.

Escobar et al., Comput. Methods Appl. Mech. Engrg. 192 (2003) 2775-2787 (less and less); Garanzha, Kaporin,
Kudryavtseva, Protais, Ray, Sokolov, ACM Trans. Graph. 40 (2021) 154 (unfolding with volumes).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.threads import MANY_VISITS, threads_for
from meshonet.geometry.volume.hex_mesh import Bools, HexMesh, corners_of
from meshonet.kernels._native import HexDescent
from meshonet.solvers.energy.hex_functional import OPENING, OPTIMAL, UNFOLDING, HexWeights
from meshonet.solvers.energy.hex_tables import HexTables, Targets, cell_lengths, tables_of

RENEWED = 10
"""Iterations after which the preconditioner follows the nodes."""
STILL = 0.3
"""Moves, in cells: two steps on end below it that also gain little end a descent."""
REACH = 0.5
"""The farthest that a node may move in a first step, in cells."""
ROUNDS, ROUND = 20, 10
"""Rounds of unfolding at the most, and iterations of each."""
NARROW = 8  # rounds after which ε is 0.3 of what it would be
WITHOUT_GAIN = 6
"""Rounds without gain after which unfolding is given up."""
SIZE = 0.1
"""Weight of the volumes of cells in unfolding."""
NEARLY = 0.05
"""Smallest Jacobian, 1 in a cell of wanted lengths, below which cells are opened before all else."""
OPENED = 20, 10, 10
"""Iterations of each stage of opening."""


@dataclass(frozen=True, eq=False)
class Slides:
    """Nodes that move in planes or along lines: their numbers (k,) and projections (k, 3, 3)."""

    nodes: Indices
    projections: Floats

    @classmethod
    def none(cls) -> Slides:
        """Return those of a mesh none of whose nodes do."""
        return cls(np.empty(0, dtype=np.intp), np.empty((0, 3, 3)))

    def among(self, nodes: Indices) -> Slides:
        """Return those among `nodes` (m,), sorted numbers, by their places there."""
        place = np.minimum(np.searchsorted(nodes, self.nodes), len(nodes) - 1)
        some = nodes[place] == self.nodes
        return Slides(place[some], self.projections[some])

    def kept(self, before: Floats, after: Floats, moves: Bools) -> Floats:
        """Return nodes (n, 3) `after` a move, of those that may, exactly where those that slide may be."""
        nodes, at = after.copy(), self.nodes
        nodes[at] = before[at] + (self.projections * (after[at] - before[at])[:, None]).sum(axis=2)
        nodes[~moves] = before[~moves]
        return nodes


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
        self.mesh, self.moves, self.iterations = mesh, moves, 0
        self.slides = Slides.none() if slides is None else slides
        self.nodes = np.ascontiguousarray(mesh.nodes).copy()
        lengths = [cell_lengths(wanted) for wanted in targets]
        tables = tables_of(mesh, moves, targets, lengths)
        rank, sliding = np.cumsum(moves) - 1, moves[self.slides.nodes]
        unknowns = np.ascontiguousarray(rank[self.slides.nodes[sliding]], dtype=np.intp)
        projections = np.ascontiguousarray(self.slides.projections[sliding].reshape(-1, 9))
        sizes = _sizes(mesh, lengths)[tables.free]
        self.descent = descent_of(self.nodes, tables, 1.0 / sizes, mesh.cells, (unknowns, projections))

    def run(self, weights: HexWeights, most: int, epsilon: float = 0.0) -> tuple[float, float]:
        """Take `most` iterations, fewer without gain; return the smallest Jacobian and the value."""
        size = SIZE if epsilon > 0.0 else 0.0
        self.descent.weigh(weights.shape, weights.smoothness, weights.power, epsilon, size)
        value, smallest, done = self.descent.run(weights.gain, most, RENEWED, STILL, REACH)
        self.iterations += done
        return smallest, value

    def smallest(self) -> float:
        """Return the smallest corner Jacobian, 1 in a cell of wanted lengths."""
        self.descent.weigh(UNFOLDING.shape, 0.0, 1, 1.0)
        return self.descent.smallest()

    def unfold(self, smallest: float, rounds: int = ROUNDS, iterations: int = ROUND) -> float:
        """Lower the regularised functional while a Jacobian is not positive; return the smallest."""
        best, idle = smallest, 0
        for count in range(rounds):
            if smallest > 0.0 or idle == WITHOUT_GAIN:
                break
            epsilon = np.sqrt(1e-4 + 0.04 * smallest * smallest) * (1.0 if count < NARROW else 0.3)
            smallest = self.run(UNFOLDING, iterations, float(epsilon))[0]
            idle = 0 if smallest > 0.9 * best else idle + 1
            best = max(best, smallest)
        return smallest

    def open(self) -> float:
        """Open flat cells of a valid mesh; return the smallest Jacobian."""
        smallest = 0.0
        for weights, most in zip((UNFOLDING, *OPENING), OPENED, strict=True):
            smallest = self.run(weights, most)[0]
        return smallest

    def result(self) -> Floats:
        """Return the nodes (n, 3) where the descent is; those that slide exactly where they may be."""
        return self.slides.kept(self.mesh.nodes, self.nodes, self.moves)


def descent_of(
    nodes: Floats, tables: HexTables, inverse_sizes: Floats, cells: int, slides: tuple[Indices, Floats],
    over: tuple[float, float, float] | None = None,
) -> HexDescent:  # fmt: skip
    """Return the compiled descent of nodes (n, 3) that `tables` are of."""
    of_places = tables.node, tables.target, tables.inverse, tables.skip, tables.busy
    places = tables.free, tables.start, tables.place, np.ascontiguousarray(inverse_sizes)
    threads = threads_for(len(nodes), MANY_VISITS)
    return HexDescent(nodes, tables.blocks, of_places, places, slides, float(cells), threads, over)


def _sizes(mesh: HexMesh, lengths: list[Floats]) -> Floats:
    """Return the mean wanted length (n,) of the sides of the cells at each node."""
    total, count = np.zeros(len(mesh.nodes)), np.zeros(len(mesh.nodes))
    for block, wanted in zip(mesh.blocks, lengths, strict=True):
        mean = wanted.mean(axis=0)
        for corner in corners_of(block):
            at = corner.ravel()
            total += np.bincount(at, mean.ravel(), len(total))
            count += np.bincount(at, minlength=len(total))
    return total / np.maximum(count, 1)


def optimise(
    mesh: HexMesh, moves: Bools, targets: Targets, *, slides: Slides | None = None, iterations: int = 60,
    tolerance: float = 1e-5, rounds: int = ROUNDS,
) -> HexOptimum:  # fmt: skip
    """Return the nodes of `mesh`, of which `moves` (n,) are free, where the functional is least.

    It ends after so many `iterations`, not counting those of unfolding, or when two in a row gain less than
    `tolerance` of the value. Folded cells are unfolded first, in so many `rounds` at the most. Cells with no
    node that moves are left out.
    """
    problem = HexProblem(mesh, moves, targets, slides)
    low = problem.unfold(problem.smallest(), rounds)
    if low <= 0.0:
        return HexOptimum(problem.result(), low, np.inf, problem.iterations)
    if low < NEARLY:
        problem.open()
    low, value = problem.run(replace(OPTIMAL, gain=tolerance), iterations)
    return HexOptimum(problem.result(), low, value, problem.iterations)
