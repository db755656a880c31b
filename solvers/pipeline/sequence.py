"""A grid from coarser copies of itself: solve on every 2^k-th boundary node, then refine and solve again.

::

    res              2 res - 1             4 res - 3
    solve --prolong--> solve --prolong-->  solve

The nodes of each boundary are among those of the next finer one. A solution is carried up as
`meshonet.solvers.pipeline.coarse` does it: what it adds to the transfinite interpolation of its edges, by cubic splines.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.coarsen import coarser_boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.solvers.pipeline.coarse import evaluate
from meshonet.solvers.solution import Solution


def solve_refined(boundary: Boundary, method: Callable[..., Solution], levels: int) -> Solution:
    """Solve on every 2^levels-th node of `boundary`, and again on twice as many cells until on all of them.

    Parameters
    ----------
    boundary : with cells along xi and eta that 2^levels divides.
    method : a solver of boundary to solution that takes ``initial``, a grid to start from.
    levels : how often cells are halved.

    Returns
    -------
    Solution
        that of the last solve, with the seconds of all and the counts of each in the notes.

    Raises
    ------
    InputError
        counts that cannot be halved.
    """
    solution = method(coarser_boundary(boundary, 2**levels))
    seconds, counts = dict(solution.seconds), [_told(solution)]
    for k in range(levels - 1, -1, -1):
        finer = coarser_boundary(boundary, 2**k) if k else boundary
        start = Grid.from_nodes(evaluate(solution.grid.nodes, finer), boundary.topology, finer.patches)
        solution = method(finer, initial=start)
        seconds = {stage: seconds.get(stage, 0.0) + spent for stage, spent in solution.seconds.items()}
        counts.append(_told(solution))
    grid = solution.grid.with_provenance(refined=levels)
    return replace(
        solution, grid=grid, seconds=seconds, notes=(*solution.notes, "refined: " + ", ".join(counts))
    )


def _told(solution: Solution) -> str:
    grid, cycles = solution.grid, solution.cycles
    return f"{grid.ni}x{grid.nj}" + (
        f" in {cycles} cycle{'' if cycles == 1 else 's'}" if cycles is not None else ""
    )
