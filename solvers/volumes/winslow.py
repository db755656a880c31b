"""Winslow's grid inside six faces, to the accuracy of the discretisation."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.errors import SolverError
from meshonet.solvers.iteration import check_tolerances
from meshonet.solvers.solution import Outcome, Solution, timed
from meshonet.solvers.stages import reached
from meshonet.solvers.volumes.edge_corners import check_corners
from meshonet.solvers.volumes.multigrid import VolumeMultigrid

CYCLES = 100  # largest number of cycles on all nodes
RATE = 0.4  # assumed convergence factor of a cycle until two cycles have measured it
ENOUGH = 1.0  # allowed iteration error relative to the discretisation error
CAREFUL = ((1, 1.0), (2, 0.7))
"""Sweeps before and after coarser levels, and relaxation factors, tried in turn if cycles diverge."""


@timed
def winslow(faces: SixFaces, *, tol: float | None = None, max_cycles: int | None = None) -> Solution:
    """Solve Winslow's equations inside `faces`: computational coordinates are harmonic functions of x, y, z.

    ``a11 x_11 + a22 x_22 + a33 x_33 + 2 (a12 x_12 + a13 x_13 + a23 x_23) = 0``, with the adjugate a of the
    metric, is solved by central differences and multigrid. Cells can fold where walls are re-entrant. Cycles
    end when they change nodes by less than the discretisation error, or when the residual is `tol` times the
    residual of the transfinite interpolation. Winslow, J. Comput. Phys. 1 (1966) 149-172.

    Raises InputError if cells fold wherever the inner nodes are or if a setting is out of its range, and
    SolverError if cycles diverge.
    """
    check_tolerances(tol, max_cycles)
    check_corners(faces)
    most = CYCLES if max_cycles is None else max_cycles
    for sweeps, factor in CAREFUL:
        x, cycles, residual, done = _solved(VolumeMultigrid(faces, sweeps, factor), tol, most)
        if np.isfinite(x).all():
            grid = faces.grid(np.moveaxis(x, 0, -1), {"method": "winslow", "cycles": cycles})
            outcome = Outcome.DONE if done else Outcome.UNCONVERGED
            return Solution(grid, "winslow", residual=residual, cycles=cycles, outcome=outcome)
    raise SolverError("Winslow's equations have no solution that cycles reach: use {method} variational")


def _solved(
    multigrid: VolumeMultigrid, tol: float | None, most: int
) -> tuple[Floats, int, float | None, bool]:
    """Return the nodes, the number of cycles, the residual if `tol` is given, and whether it converged."""
    x, apart, change = multigrid.nested()
    cycles = 1
    if tol is not None:
        first = multigrid.norm(multigrid.levels[0].start) or 1.0
        norm = multigrid.norm(x) / first
        while norm > tol and cycles < most and np.isfinite(norm):
            multigrid.cycle(x)
            norm, cycles = multigrid.norm(x) / first, cycles + 1
            reached("grid", "cycle", cycles)
        return x, cycles, norm, norm <= tol
    rate = RATE
    while change * rate > ENOUGH * (1.0 - rate) * apart / 3.0 and cycles < most and np.isfinite(change):
        last = change
        change, cycles = multigrid.cycle(x)[1], cycles + 1
        reached("grid", "cycle", cycles)
        rate = min(max(change / last, 0.2), 0.95)
    return x, cycles, None, change * rate <= ENOUGH * (1.0 - rate) * apart / 3.0
