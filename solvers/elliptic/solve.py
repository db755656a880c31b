"""Boundary in, Winslow grid out: start, cycles, stop, and what to do when they diverge."""

from __future__ import annotations

import time

import numpy as np

from geometry.arrays import Floats, planar_nodes
from geometry.boundary import Boundary
from geometry.errors import InputError, SolverError
from geometry.grid import Grid
from solvers.elliptic.multigrid import Multigrid, Settings
from solvers.solution import Solution

ATTEMPTS = (Settings(), Settings(coarsest=32, sweeps=2), Settings(coarsest=64, sweeps=4))
"""Settings tried in turn when the residual grows or is not finite."""


class _DivergedError(Exception):
    """The residual is not finite or grew."""


def solve(
    boundary: Boundary, *, tol: float | None = None, max_cycles: int = 30, initial: Grid | None = None
) -> Solution:
    """Solve Winslow's equations for the nodes inside `boundary`.

    Parameters
    ----------
    boundary : quad or o.
    tol : stop when the residual is this fraction of that of the transfinite interpolation; None stops at
        discretisation level, when more cycles would change the grid by less than refining it would.
    max_cycles : cycles on the finest level at the most.
    initial : start from this grid, of the same node counts, instead of nested iteration; its boundary
        nodes are replaced.

    Returns
    -------
    Solution
        the grid, the residual relative to the transfinite interpolation, cycles, seconds. It may be folded
        at re-entrant corners: see `solvers.guard`.

    Raises
    ------
    InputError
        a C boundary; `initial` of other node counts; `tol` or `max_cycles` not positive.
    SolverError
        the iteration diverged from every start tried.
    """
    _check(boundary, tol, max_cycles, initial)
    begun = time.perf_counter()
    notes: tuple[str, ...] = ()
    for k, settings in enumerate(ATTEMPTS):
        try:
            nodes, residual, cycles = _attempt(boundary, tol, max_cycles, initial, settings)
        except _DivergedError as error:
            notes += (f"attempt {k + 1} diverged ({error})",)
            initial = None
            continue
        facts = {"method": "winslow", "residual": residual, "cycles": cycles}
        grid = Grid(nodes, boundary.topology, boundary.parts, boundary.name, facts)
        spent = {"grid": time.perf_counter() - begun}
        return Solution(grid, "winslow", residual=residual, cycles=cycles, seconds=spent, notes=notes)
    raise SolverError(
        f"Winslow's equations diverged from every start ({'; '.join(notes)}); use more nodes or tfi"
    )


def _attempt(
    boundary: Boundary, tol: float | None, max_cycles: int, initial: Grid | None, settings: Settings
) -> tuple[Floats, float, int]:
    """Return nodes, relative residual and cycles of one try; raise _DivergedError."""
    nodes = planar_nodes(boundary.ni, boundary.nj)
    edges = (boundary.south, boundary.north, boundary.west, boundary.east)
    periodic = boundary.topology == "o"
    levels = Multigrid(nodes, edges, periodic, settings)
    if initial is None:
        start = levels.nested_iteration()
    else:
        levels.interpolate_edges(0)
        start = levels.residual()
        inside = slice(0 if periodic else 1, None if periodic else -1)
        nodes[inside, 1:-1] = initial.nodes[inside, 1:-1]
    if start == 0.0:
        return nodes, 0.0, 0
    goal = (tol if tol is not None else 1e-3) * start
    residual = last = levels.residual()
    cycles = 0
    while not residual <= goal and cycles < max_cycles:
        levels.cycle()
        cycles += 1
        last, residual = residual, levels.residual()
        if not np.isfinite(residual) or residual > 10 * max(last, goal):
            raise _DivergedError(f"residual {residual / start:.1e} after {cycles} cycles")
    return nodes, residual / start, cycles


def _check(boundary: Boundary, tol: float | None, max_cycles: int, initial: Grid | None) -> None:
    if boundary.topology == "c":
        raise InputError("a C boundary cannot be solved yet", "use topology quad or o")
    if tol is not None and not 0 < tol < 1:
        raise InputError(f"tolerance {tol:g} is not between 0 and 1", "use e.g. 1e-8")
    if max_cycles < 1:
        raise InputError(f"{max_cycles} cycles are too few", "allow at least 1")
    if initial is not None and initial.nodes.shape[:2] != (boundary.ni, boundary.nj):
        had = f"{initial.ni}x{initial.nj}"
        raise InputError(
            f"the initial grid has {had} nodes, not {boundary.ni}x{boundary.nj}", "give equal counts"
        )
