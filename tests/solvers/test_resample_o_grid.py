"""O grids evaluated from few nodes keep the course of their lines, and do not fold where steps jump."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from solver_shapes import circle, folded, polyline, ring

from meshonet.geometry.arrays import Floats, as_planar
from meshonet.solvers.algebraic.resample.grids import refine_grid, thinned
from meshonet.solvers.algebraic.resample.o_grid import refine_around


def rings(radii: Floats, ni: int) -> Floats:
    """Circles of the `radii`, clockwise, as nodes (ni, nj, 2)."""
    turn = circle(1.0, ni)
    return as_planar(turn[:, None] * radii[None, :, None])


def test_rings_that_grow_come_back() -> None:
    fine = rings(np.geomspace(1.0, 20.0, 65), 129)
    boundary = ring(fine[:, 0], fine[:, -1], 65)
    result = refine_grid(as_planar(fine[::2, ::2]), boundary)
    assert np.abs(result - fine).max() < 1e-4 * 20.0
    assert np.array_equal(result[:, 0], boundary.south)
    assert np.array_equal(result[:, -1], boundary.north)
    assert np.array_equal(result[0], result[-1])


def test_where_steps_jump_lines_do_not_turn_back() -> None:
    steps = np.concatenate([np.full(8, 1.0), np.full(8, 0.01), np.full(8, 1.0)])
    radii = np.concatenate([[1.0], 1.0 + np.cumsum(steps)])
    places = np.linspace(0.0, 24.0, 97)
    assert np.diff(CubicSpline(np.arange(25.0), radii)(places)).min() < -0.01
    boundary = ring(circle(1.0, 65), circle(float(radii[-1]), 65), 97)
    result = refine_grid(rings(radii, 33), boundary)
    assert folded(result) == 0
    reach = np.hypot(result[..., 0], result[..., 1])
    assert np.diff(reach, axis=1).min() > 0.0
    np.testing.assert_allclose(reach[::2, ::4].mean(axis=0), radii, atol=1e-6)


def test_a_corner_between_coarse_nodes_is_felt_near_the_wall_only() -> None:
    corners: list[tuple[float, float]] = [(1.0, 0.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
    square = polyline([*corners, (1.0, 0.0)], 121)
    boundary = ring(square, circle(8.0, 121), 61)
    coarse = thinned(boundary, 37, 31)
    assert np.abs(coarse.south - (1.0, -1.0)).sum(axis=1).min() > 0.02
    t = np.linspace(0.0, 1.0, 31)[None, :, None]
    result = refine_around(as_planar((1 - t) * coarse.south[:, None] + t * coarse.north[:, None]), boundary)
    assert folded(result) == 0
    exact = np.linspace(0.0, 1.0, 61)[None, :, None]
    plain = (1 - exact) * boundary.south[:, None] + exact * boundary.north[:, None]
    bends = [np.abs(np.diff(nodes, 2, axis=0))[:, 40].max() for nodes in (result, plain)]
    assert bends[0] < 0.5 * bends[1]


@pytest.mark.parametrize("n", [2, 3, 4])
@pytest.mark.parametrize("nj", [5, 12])
def test_few_layers_do(n: int, nj: int) -> None:
    boundary = ring(circle(1.0, 33), circle(2.0, 33), nj)
    result = refine_grid(rings(np.linspace(1.0, 2.0, n), 17), boundary)
    expected = rings(np.linspace(1.0, 2.0, nj), 33)
    np.testing.assert_allclose(result, expected, atol=2e-4)
