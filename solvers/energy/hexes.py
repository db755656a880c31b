"""Joint optimisation of all nodes of a multi-block hexahedral mesh with one functional.

Escobar et al., Comput. Methods Appl. Mech. Engrg. 192 (2003) 2775-2787 (regularisation); Garanzha et al., ACM
Trans. Graph. 40 (2021) 154 (untangling with volumes).
"""

from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.threads import MANY_VISITS, threads_for
from meshonet.geometry.volume.hex_mesh import HexMesh, corners_of
from meshonet.kernels._native import HexDescent
from meshonet.solvers.energy.hex_functional import OPENING, OPTIMAL, UNFOLDING, HexWeights
from meshonet.solvers.energy.hex_tables import HexTables, Targets, cell_lengths, tables_of

RENEWED = 10  # number of iterations after which the preconditioner is updated
STILL = 0.3  # displacement, in cells, below which two consecutive steps of little gain end a minimisation
REACH = 0.5  # largest displacement of a node in a first step, in cells
ROUNDS, ROUND = 20, 10  # largest number of rounds of untangling, and iterations of each
NARROW = 8  # rounds after which ε is 0.3 of what it would be
WITHOUT_GAIN = 6  # number of rounds without improvement after which untangling is given up
SIZE = 0.1  # weight of the volumes of cells in untangling
NEARLY = 0.05  # smallest Jacobian, relative to a cell with target lengths, below which cells are opened first
OPENED = 20, 10, 10  # iterations of each stage of opening


@dataclass(frozen=True, eq=False)
class Slides:
    """Nodes that slide in planes or on lines: indices (k,), and the projections (k, 3, 3) of moves."""

    nodes: Indices
    projections: Floats

    @classmethod
    def none(cls) -> "Slides":
        """Return the object for a mesh without sliding nodes."""
        return cls(np.empty(0, dtype=np.intp), np.empty((0, 3, 3)))

    def among(self, nodes: Indices) -> "Slides":
        """Return the sliding nodes that are among sorted `nodes` (m,), each with its position in `nodes`."""
        place = np.minimum(np.searchsorted(nodes, self.nodes), len(nodes) - 1)
        some = nodes[place] == self.nodes
        return Slides(place[some], self.projections[some])

    def kept(self, before: Floats, after: Floats, moves: Bools) -> Floats:
        """Return the displaced nodes `after` (n, 3), with sliding nodes projected to their planes and lines.

        `before` (n, 3) are the nodes before the displacement; nodes outside the mask `moves` stay there.
        """
        nodes, at = after.copy(), self.nodes
        nodes[at] = before[at] + (self.projections * (after[at] - before[at])[:, None]).sum(axis=2)
        nodes[~moves] = before[~moves]
        return nodes


@dataclass(frozen=True, eq=False)
class HexOptimum:
    """Result of `optimise`."""

    nodes: Floats  # (n, 3) nodes; nodes that are not free are bitwise unchanged
    smallest: float  # smallest corner Jacobian of cells with free nodes, relative to their target volume
    value: float
    iterations: int

    @property
    def valid(self) -> bool:
        """Whether no cell with free nodes is folded."""
        return self.smallest > 0.0


class HexProblem:
    """Minimisation of the functional of `HexWeights`; only the nodes in the mask `moves` (n,) move."""

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
        """Do up to `most` iterations with ε = `epsilon`; return the smallest Jacobian and the functional."""
        size = SIZE if epsilon > 0.0 else 0.0
        self.descent.weigh(weights.shape, weights.smoothness, weights.power, epsilon, size)
        value, smallest, done = self.descent.run(weights.gain, most, RENEWED, STILL, REACH)
        self.iterations += done
        return smallest, value

    def smallest(self) -> float:
        """Return the smallest corner Jacobian; it is 1 for a cell with target lengths and right angles."""
        self.descent.weigh(UNFOLDING.shape, 0.0, 1, 1.0)
        return self.descent.smallest()

    def unfold(self, smallest: float, rounds: int = ROUNDS, iterations: int = ROUND) -> float:
        """Untangle cells in up to `rounds` rounds. Return the least Jacobian, which was `smallest` before."""
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
        """Make nearly flat cells thicker, in a mesh without folded cells; return the smallest Jacobian."""
        smallest = 0.0
        for weights, most in zip((UNFOLDING, *OPENING), OPENED, strict=True):
            smallest = self.run(weights, most)[0]
        return smallest

    def result(self) -> Floats:
        """Return the current nodes (n, 3); sliding nodes are exactly in their planes or on their lines."""
        return self.slides.kept(self.mesh.nodes, self.nodes, self.moves)


def descent_of(
    nodes: Floats, tables: HexTables, inverse_sizes: Floats, cells: int, slides: tuple[Indices, Floats],
    over: tuple[float, float, float] | None = None,
) -> HexDescent:  # fmt: skip
    """Return the compiled minimisation over the `nodes` (n, 3) of a mesh (see `HexProblem`)."""
    of_places = tables.node, tables.target, tables.inverse, tables.skip, tables.busy
    places = tables.free, tables.start, tables.place, np.ascontiguousarray(inverse_sizes)
    threads = threads_for(len(nodes), MANY_VISITS)
    return HexDescent(nodes, tables.blocks, of_places, places, slides, float(cells), threads, over)


def _sizes(mesh: HexMesh, lengths: list[Floats]) -> Floats:
    """Return the mean target length (n,) of the edges of the cells at each node."""
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
    """Return the nodes of `mesh` that minimise a functional of cell angles and edge lengths (`HexWeights`).

    Only nodes in the mask `moves` (n,) move. Folded cells are untangled first, in at most `rounds` rounds.
    The minimisation ends after `iterations`, or if two consecutive iterations each lower the functional by
    less than the fraction `tolerance`. Cells without free nodes are ignored.
    """
    problem = HexProblem(mesh, moves, targets, slides)
    low = problem.unfold(problem.smallest(), rounds)
    if low <= 0.0:
        return HexOptimum(problem.result(), low, np.inf, problem.iterations)
    if low < NEARLY:
        problem.open()
    low, value = problem.run(replace(OPTIMAL, gain=tolerance), iterations)
    return HexOptimum(problem.result(), low, value, problem.iterations)
