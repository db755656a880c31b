"""Winslow's equations by line relaxation alone, on one grid."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import MultigridLevel, multigrid_scratch
from meshonet.solvers.elliptic.coarsening import uniform


def relax(nodes: Floats, sweeps: int) -> None:
    """Relax the inner nodes of planar `nodes` (ni, nj, 2) in place by so many sweeps."""
    xi, eta = (uniform(n, False).differences for n in nodes.shape[:2])
    scratch = np.empty(multigrid_scratch(nodes.shape[0] - 1, nodes.shape[1] - 1))
    MultigridLevel(nodes[..., 0], nodes[..., 1], xi, eta, False, scratch, False).smooth(False, sweeps)
