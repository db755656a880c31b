"""Expected errors of grids by networks: what a few steps of the imitated solver change."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshonet.geometry.arrays import as_planar
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.quality.compare import compare
from meshonet.solvers.algebraic.resample.grids import refine_grid, thinned

Goal = Literal["winslow", "variational", "conformal"]  # name of the method whose grids a network imitates

THRESHOLD = 0.03  # largest expected error of accepted grids (docs/benchmarks/confidence.md)
MOST = 129  # nodes along a direction from which an answer is judged on fewer nodes
CYCLES = 2  # multigrid cycles for Winslow's equations
ITERATIONS = 16  # of the minimisation of the variational functional


@dataclass(frozen=True)
class Confidence:
    """The expected error of a neural operator's grid, and whether the grid is accepted."""

    expected_error: float  # expected relative L2 distance from the imitated solution; infinite if unknown
    threshold: float  # largest expected error of accepted grids
    accepted: bool  # whether the expected error is small enough and no cell is folded


def expected_error(grid: Grid, boundary: Boundary, goal: Goal) -> float:
    """Return the estimated relative L2 error of `grid` against the converged grid of the method `goal`.

    The estimate is the change of `grid` by a few iterations of that method, ``winslow`` or ``variational``.
    It is infinite if the method cannot start from `grid`.
    """
    counts = tuple(min(n, MOST) for n in (boundary.ni, boundary.nj))
    if counts != (boundary.ni, boundary.nj):
        boundary = thinned(boundary, *counts)
        grid = boundary.grid(as_planar(refine_grid(grid.nodes, boundary)))
    try:
        if goal == "winslow":
            from meshonet.solvers.elliptic.solve import solve

            better = solve(boundary, tol=1e-12, max_cycles=CYCLES, initial=grid).grid
        else:
            better = _nearer_optimum(grid, boundary)
        error = compare(grid, better).relative_l2
    except (InputError, SolverError):
        return math.inf
    return error if math.isfinite(error) else math.inf


def _nearer_optimum(grid: Grid, boundary: Boundary) -> Grid:
    from meshonet.solvers.energy.descent import descend
    from meshonet.solvers.energy.variational import STILL, WEIGHTS

    nodes = as_planar(np.array(grid.nodes))
    weights = WEIGHTS[boundary.topology]
    _, valid = descend(nodes, weights, STILL, ITERATIONS, periodic=boundary.periodic)
    if not valid:
        raise SolverError("cells stay folded")
    return boundary.grid(nodes)
