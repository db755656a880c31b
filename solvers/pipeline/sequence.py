"""A grid from coarser copies of itself: solve on every 2^k-th boundary node, then refine and solve again.

::

    res              2 res - 1             4 res - 3
    solve --prolong--> solve --prolong-->  solve

The nodes of each boundary are among those of the next finer one. A solution is evaluated at the finer nodes
as a coarse one is (`meshonet.solvers.algebraic.resample.grids`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.transform import coarser_boundary
from meshonet.solvers.algebraic.resample.grids import evaluate
from meshonet.solvers.method import Wrapper
from meshonet.solvers.solution import Solution


@dataclass(frozen=True)
class Sequenced(Wrapper):
    """`method` on every 2^levels-th node, then on twice as many cells until on all (`solve_refined`)."""

    levels: int

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of a boundary; a grid to start from has the coarsest counts."""
        return solve_refined(boundary, self.inner, self.levels, start)


def solve_refined(
    boundary: Boundary, solve: Callable[..., Solution], levels: int, initial: Grid | None = None
) -> Solution:
    """Solve on every 2^levels-th node of `boundary`, and again on twice as many cells until on all of them.

    Parameters
    ----------
    boundary : with cells along xi and eta that 2^levels divides.
    solve : a function of boundary to solution that takes ``initial``, a grid to start from.
    levels : how often cells are halved.
    initial : what the coarsest solve starts from.

    Its seconds are those of all solves, and a note has the counts of each. Raises InputError: counts that
    cannot be halved.
    """
    solution = solve(coarser_boundary(boundary, 2**levels), initial=initial)
    seconds, counts = dict(solution.seconds), [_counts(solution)]
    for k in range(levels - 1, -1, -1):
        finer = coarser_boundary(boundary, 2**k) if k else boundary
        start = Grid.from_nodes(evaluate(solution.grid.nodes, finer), boundary.topology, finer.patches)
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
