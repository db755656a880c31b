"""Solves on every 2^k-th boundary node, then refines and solves again."""

from collections.abc import Callable
from dataclasses import dataclass, replace

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.transform import coarser_boundary
from meshonet.solvers.algebraic.resample.grids import refine_grid
from meshonet.solvers.pipeline.wrapper import Wrapper
from meshonet.solvers.solution import Solution


@dataclass(frozen=True)
class Sequenced(Wrapper):
    """Solves by `method` on every 2^levels-th node, then with half the step, and so on up to all nodes."""

    levels: int

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of a boundary; an initial grid must have the coarsest node counts."""
        return solve_refined(boundary, self.inner, self.levels, start)


def solve_refined(
    boundary: Boundary, solve: Callable[..., Solution], levels: int, initial: Grid | None = None
) -> Solution:
    """Solve on every 2^levels-th node of `boundary`, then with half the step, and so on up to all nodes.

    `solve` has a parameter ``initial``, an initial grid; on the coarsest level it is the given `initial`.
    Raises InputError: the counts cannot be halved so often.
    """
    solution = solve(coarser_boundary(boundary, 2**levels), initial=initial)
    seconds, counts = dict(solution.seconds), [_counts(solution)]
    for k in range(levels - 1, -1, -1):
        finer = coarser_boundary(boundary, 2**k) if k else boundary
        start = Grid.from_nodes(refine_grid(solution.grid.nodes, finer), boundary.topology, finer.patches)
        solution = solve(finer, initial=start)
        seconds = {stage: seconds.get(stage, 0.0) + spent for stage, spent in solution.seconds.items()}
        counts.append(_counts(solution))
    grid = solution.grid.with_provenance(refined=levels)
    notes = (*solution.notes, "refined: " + ", ".join(counts))
    return replace(solution, grid=grid, seconds=seconds, notes=notes)


def _counts(solution: Solution) -> str:
    grid, cycles = solution.grid, solution.cycles
    counts = f"{grid.ni}x{grid.nj}"
    return counts if cycles is None else f"{counts} in {cycles} cycle{'' if cycles == 1 else 's'}"
