"""Where descents start: Winslow's solution on the coarsest level."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import SolverError
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.multigrid import relax

RELAXED = 400  # cells up to which line relaxation alone is the quickest way to Winslow's solution
SWEEPS = 30  # sweeps there: they leave some thousandths of the change from the transfinite interpolation


def winslow_start(boundary: Boundary) -> Floats:
    """Return about Winslow's solution inside `boundary`, planar (ni, nj, 2).

    Where its equations have no discrete one it is the transfinite interpolation, which may be folded.
    """
    if not boundary.around_body and (boundary.ni - 1) * (boundary.nj - 1) <= RELAXED:
        nodes = tfi(boundary).nodes
        relax(nodes, SWEEPS)
        if np.isfinite(nodes).all():
            return nodes
    from meshonet.solvers.elliptic.solve import solve as winslow

    try:
        return winslow(boundary, tol=1e-3, initial=tfi(boundary)).grid.nodes
    except SolverError:
        return tfi(boundary).nodes
