"""Windows around skewed cells are minimised by themselves, and leave the rest of a grid alone."""

import numpy as np
from functional_reference import energy
from solver_shapes import circle, folded, ring

from meshonet.geometry.arrays import as_planar
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.energy.descent import SKEWED, corner_distortion, descend_windows
from meshonet.solvers.energy.functional import AROUND, aspect_of, relief_of


def test_skewness_is_that_of_the_angle() -> None:
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")
    sheared = as_planar(np.stack([x + 0.5 * y, y], axis=-1))
    np.testing.assert_allclose(corner_distortion(sheared), 1.25**2)
    sheared[1, 1] += 3.0
    assert np.isinf(corner_distortion(sheared)).any()


def test_folded_cells_are_mended_and_far_ones_stay() -> None:
    boundary = ring(circle(1.0, 97), circle(3.0, 97), 33)
    nodes = tfi(boundary).nodes.copy(order="K")
    aspect, relief = aspect_of(nodes, True), relief_of(nodes[:, 0])
    best = energy(nodes, aspect, AROUND, periodic=True)
    before = nodes.copy(order="K")
    nodes[1:3, 10] = nodes[2:0:-1, 11]  # beside the seam
    nodes[-1] = nodes[0]
    assert folded(nodes) > 0
    descend_windows(nodes, aspect, AROUND, relief)
    assert folded(nodes) == 0
    assert corner_distortion(nodes).max() < SKEWED
    assert energy(nodes, aspect, AROUND, periodic=True) < best + 2e-3
    assert np.array_equal(nodes[0], nodes[-1])
    assert np.array_equal(nodes[30:70], before[30:70])
    assert np.array_equal(nodes[:, 0], before[:, 0])
