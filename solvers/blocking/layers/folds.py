"""Folded cells of quad meshes, and few of them unfolded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.lattice import corner_jacobians
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.energy.quads import optimise

FEW_ITERATIONS = 10
NEAR_FOLDS = 5
"""Cells around folded ones that are optimised with them."""


def unfolded(layout: Layout, held: NDArray[np.bool_]) -> Layout:
    """Return the layout with nodes near folded cells, but for `held` (n,) ones, moved to unfold them."""
    mesh = layout.mesh
    bad = smallest_corners(mesh) <= 0.0
    if not bad.any():
        return layout
    free = np.zeros(len(mesh.nodes), dtype=bool)
    free[mesh.quads[bad]] = True
    for _ in range(NEAR_FOLDS):
        free[mesh.quads[free[mesh.quads].any(axis=1)]] = True
    optimum = optimise(mesh, iterations=FEW_ITERATIONS, held=held | ~free)
    return replace(layout, mesh=optimum.mesh) if optimum.valid else layout


def smallest_corner(mesh: QuadMesh) -> float:
    """Return the smallest Jacobian, of parallelograms at corners, of the quads of a mesh."""
    return float(smallest_corners(mesh).min())


def smallest_corners(mesh: QuadMesh) -> Floats:
    """Return the smallest corner Jacobian (m,) of each quad of a mesh."""
    return np.asarray(corner_jacobians(mesh.nodes[mesh.quads]).min(axis=1))
