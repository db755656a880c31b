"""Solves on few nodes, and evaluates the result at the nodes of the grid."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.resample.grids import check_coarse, refine_grid, thinned
from meshonet.solvers.pipeline.methods import METHODS
from meshonet.solvers.pipeline.wrapper import Wrapper
from meshonet.solvers.solution import Solution

if TYPE_CHECKING:
    pass


@dataclass(frozen=True)
class Coarse(Wrapper):
    """`method` on at most n x n nodes, evaluated at the node counts of the boundary (`solve_coarse`)."""

    n: int

    def solve_one(self, boundary: Boundary, start: Grid | None = None) -> Solution:  # noqa: ARG002
        """Return the solution of a boundary; an initial grid is not used."""
        smooth = self.name not in METHODS or METHODS[self.name].sweeps
        return solve_coarse(boundary, self.inner, self.n, smooth=smooth)


def solve_coarse(
    boundary: Boundary, solve: Callable[[Boundary], Solution], n: int, *, smooth: bool
) -> Solution:
    """Solve by `solve` on at most n x n nodes; return the grid interpolated to the nodes of `boundary`.

    Residual and cycles are those of the coarse solution. With `smooth`, Winslow's equations are relaxed near
    kinks of the boundary: always for their own solutions and folded grids, otherwise only if angles improve.
    Raises InputError: `n` is below 9.
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
