"""Solves on few nodes, and evaluates the result at the nodes of the grid, or refines and solves again."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.transform import coarser_boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.resample.grids import check_coarse, refine_grid, thinned
from meshonet.solvers.pipeline.methods import METHODS
from meshonet.solvers.pipeline.named import Wrapper
from meshonet.solvers.solution import Solution


@dataclass(frozen=True)
class Coarse(Wrapper):
    """Solves by `method` on at most n x n nodes, and interpolates to all nodes (`solve_coarse`)."""

    n: int

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:  # noqa: ARG002
        """Return the solution of a boundary; an initial grid is not used."""
        smooth = self.name not in METHODS or METHODS[self.name].sweeps
        return solve_coarse(boundary, self.inner, self.n, smooth=smooth)


def solve_coarse(
    boundary: Boundary, solve: Callable[[Boundary], Solution], n: int, *, smooth: bool
) -> Solution:
    """Solve by `solve` on at most n x n nodes; return the grid interpolated to the nodes of `boundary`.

    The returned residual and cycles belong to the coarse grid. With `smooth`, nodes near kinks of the
    boundary are relaxed by Winslow's equations. The relaxed nodes are kept if the method is ``winslow``, if
    the interpolated grid is folded, or if angles improve. Raises InputError if `n` is below 9.
    """
    check_coarse(n)
    counts = min(n, boundary.ni), min(n, boundary.nj)
    if counts == (boundary.ni, boundary.nj):
        return solve(boundary)
    begun = time.perf_counter()
    solution = solve(thinned(boundary, *counts))
    nodes = refine_grid(solution.grid.nodes, boundary)
    if smooth:
        from meshonet.solvers.elliptic.kinks import sweep_kinks

        winslow = solution.method == "winslow" or count_folded(nodes) > 0
        sweep_kinks(nodes, boundary, counts, only_better=not winslow)
    facts = {**solution.grid.provenance, "coarse": counts}
    grid = boundary.grid(nodes, facts)
    return replace(solution, grid=grid, seconds={**solution.seconds, "grid": time.perf_counter() - begun})


@dataclass(frozen=True)
class Sequenced(Wrapper):
    """Solves by `method` on every 2^levels-th node, then on finer and finer grids up to all nodes."""

    levels: int

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:
        """Return the solution of a boundary; `start` is an initial grid with the coarsest node counts."""
        return solve_refined(boundary, self.inner, self.levels, start)


def solve_refined(
    boundary: Boundary, solve: Callable[..., Solution], levels: int, initial: Grid | None = None
) -> Solution:
    """Solve on every 2^levels-th node of `boundary`, then repeatedly on twice as many, up to all nodes.

    `solve` has a parameter ``initial``. On the coarsest level it gets `initial`, on each finer level the
    interpolated grid of the previous level. Raises InputError if the counts cannot be halved so often.
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
