"""Repair of folded cells of fine grids: splines through the nodes of a coarse grid can cross."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Bools
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.decomposition.symmetry.images import made_symmetric
from meshonet.solvers.energy.quads import optimise

FEW_ITERATIONS = 10  # only nodes around folds move
NEAR_FOLDS = 5  # cells around folded ones that are optimised with them


def unfolded(layout: Layout, held: Bools | None = None) -> Layout:
    """Return the layout with folded cells unfolded; nodes in `held` (n,) and aspect ratios do not change."""
    mesh = layout.mesh
    bad = smallest_jacobians(mesh.nodes, mesh.quads) <= 0.0
    if not bad.any():
        return layout
    free = np.zeros(len(mesh.nodes), dtype=bool)
    free[mesh.quads[bad]] = True
    for _ in range(NEAR_FOLDS):
        free[mesh.quads[free[mesh.quads].any(axis=1)]] = True
    lengths = np.maximum(mesh.edge_lengths, np.finfo(float).tiny)
    optimum = optimise(
        mesh,
        iterations=FEW_ITERATIONS,
        held=~free if held is None else held | ~free,
        targets=lengths,
        aspects=mesh.aspects(lengths),
    )
    return replace(layout, mesh=made_symmetric(optimum.mesh)) if optimum.valid else layout
