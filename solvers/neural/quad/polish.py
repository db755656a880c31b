"""Improves the network's grids, on coarse and on all nodes, by descent or towards Winslow's solution."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, SolverError
from meshonet.solvers.algebraic.resample.grids import refine_grid, thinned
from meshonet.solvers.neural.quad import coarse_grids, o_grids
from meshonet.solvers.neural.quad.encoding import WINSLOW
from meshonet.solvers.neural.quad.network import Network

MOST_SOLVED = 129  # nodes along a direction at the most of the grid that Winslow's equations are solved on
MOST_DESCENDED, LARGER_DESCENDED = 513, 257  # most nodes that descend in full; larger grids' nodes

LAST = 2  # largest number of steps at full resolution, which remove folds and kinks between coarse nodes

STILL = 1e-4  # moves at which a descent stops sooner, as `meshonet.solvers.energy.variational.STILL`


def polished(
    boundaries: Sequence[Boundary], network: Network, topology: Topology, head: int, steps: int
) -> tuple[Floats, list[int]]:
    """Return the network's grids (batch, 2, ni, nj), improved by a solver, and its iterations for each grid.

    The solver makes at most `steps` iterations per grid. `boundaries` have equal node counts. `head` is the
    index of the kind of grid in `encoding.HEADS`.
    """
    if topology == "quad":
        coarse = coarse_grids.coarse_grids(coarse_grids.sides_of(boundaries), network, head)
    else:
        coarse = o_grids.coarse_grids(boundaries, network, head)
    counts = boundaries[0].ni, boundaries[0].nj
    if not steps:
        return _evaluated(coarse, boundaries, counts), [0] * len(boundaries)
    newton = head != WINSLOW and topology == "quad"
    last = steps if head == WINSLOW else min((steps + 1) // 2 if newton else steps, LAST)
    begin = _newton if newton else _descent
    taken = [begin(grid, steps - last, topology) for grid in coarse]
    if head == WINSLOW:
        ni, nj = (min(n, MOST_SOLVED) for n in counts)
    else:
        ni, nj = (n if n <= MOST_DESCENDED else LARGER_DESCENDED for n in counts)
    planes = _evaluated(coarse, boundaries, (ni, nj))
    for k, grid in enumerate(planes):
        if head == WINSLOW:
            taken[k] += _cycles(grid, last, topology)
        else:
            taken[k] += _descent(grid, last, topology, coarse[k] if newton else None)
    return (planes if (ni, nj) == counts else _evaluated(planes, boundaries, counts)), taken


def _evaluated(grids: Floats, boundaries: Sequence[Boundary], counts: tuple[int, int]) -> Floats:
    if counts != (boundaries[0].ni, boundaries[0].nj):
        boundaries = [thinned(boundary, *counts) for boundary in boundaries]
    nodes = [refine_grid(np.moveaxis(grid, 0, -1), b) for grid, b in zip(grids, boundaries, strict=True)]
    return np.stack([np.moveaxis(each, -1, 0) for each in nodes])


def _newton(planes: Floats, steps: int, topology: Topology) -> int:
    """Take at most `steps` Newton steps from the grid `planes` (2, m, n) in place; return how many."""
    if not steps:
        return 0
    from meshonet.solvers.energy.descent import newton
    from meshonet.solvers.energy.variational import WEIGHTS

    return newton(np.moveaxis(planes, 0, -1), WEIGHTS[topology], steps)


def _descent(planes: Floats, steps: int, topology: Topology, coarse: Floats | None = None) -> int:
    """Descend from `planes` (2, m, n) in place, preconditioned by the `coarse` grid; return the steps."""
    if not steps:
        return 0
    from meshonet.solvers.energy.descent import descend, stiffness_of
    from meshonet.solvers.energy.variational import WEIGHTS

    weights = WEIGHTS[topology]
    stiffness = None
    if coarse is not None:
        stiffness = stiffness_of(np.moveaxis(coarse[:, ::2, ::2].copy(), 0, -1), weights)
    nodes = np.moveaxis(planes, 0, -1)
    return descend(nodes, weights, STILL, steps, periodic=topology == "o", stiffness=stiffness)[0]


def _cycles(planes: Floats, steps: int, topology: Topology) -> int:
    """Take multigrid cycles for Winslow's equations from `planes` (2, m, n), in place; return how many."""
    from meshonet.solvers.elliptic.solve import solve

    nodes = np.moveaxis(planes, 0, -1)
    try:
        boundary = Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1], topology)
        initial = boundary.grid(nodes.copy(order="K"))
        solution = solve(boundary, tol=1e-12, max_cycles=steps, initial=initial)
    except (SolverError, InputError):
        return 0  # diverged, or nodes that no boundary can have
    nodes[:] = solution.grid.nodes
    return solution.cycles or 0
