"""Repair of folded cells of fine grids: splines through the nodes of a coarse grid can cross."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Bools
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.decomposition.symmetry.images import made_symmetric
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.refinement.refine import multiplied

FEW_ITERATIONS = 10  # only nodes around folds move
NEAR_FOLDS = 5, 10, 20  # cells around folded ones that are optimised with them, in the order of attempts


def unfolded(layout: Layout, held: Bools) -> Layout:
    """Return the layout with folded cells repaired if possible; nodes in the mask `held` (n,) do not move."""
    mesh = layout.mesh
    bad = smallest_jacobians(mesh.nodes, mesh.quads) <= 0.0
    if not bad.any():
        return layout
    free, lengths = np.zeros(len(mesh.nodes), dtype=bool), np.maximum(mesh.edge_lengths, np.finfo(float).tiny)
    free[mesh.quads[bad]] = True
    for more in np.diff(NEAR_FOLDS, prepend=0):
        for _ in range(more):
            free[mesh.quads[free[mesh.quads].any(axis=1)]] = True
        optimum = optimise(
            mesh, iterations=FEW_ITERATIONS, held=held | ~free, targets=lengths, aspects=mesh.aspects(lengths)
        )
        if optimum.valid:
            return replace(layout, mesh=made_symmetric(optimum.mesh))
    return layout


def with_more_cells(layout: Layout, times: int) -> Layout:
    """Return the layout with each cell divided into `times` x `times` cells; folded cells are repaired."""
    fine = multiplied(layout, times)
    return unfolded(fine, fine.mesh.wall_nodes)
