"""Newton's method on the variational functional, with its exact Hessian or as much of it as is positive."""

import numpy as np
import pytest
from random_quads import random_quad
from solver_shapes import arch, bump, wrench

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.kernels._native import newton as compiled
from meshonet.kernels._native import variational_energy
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.energy.descent import newton, stiffness_of
from meshonet.solvers.energy.functional import Weights, aspect_of
from meshonet.solvers.energy.untangle import unfold
from meshonet.solvers.energy.variational import solve


def value_and_slope(nodes: Floats) -> tuple[float, float]:
    """Return the functional and the largest entry of its gradient."""
    z, weights = np.moveaxis(nodes, -1, 0), Weights()
    gradient = np.empty_like(z)
    terms = aspect_of(nodes), weights.shape, weights.smoothness, 0.0, False, None
    value, _ = variational_energy(z, *terms, gradient)
    return value, float(np.abs(gradient).max())


def shaken(boundary: Boundary, size: float) -> Floats:
    """Return the minimum inside a boundary, its inner nodes moved at random by `size` of a step."""
    nodes = solve(boundary, tol=1e-6).grid.nodes.copy(order="K")
    rng = np.random.default_rng(0)
    nodes[1:-1, 1:-1] += size / len(nodes) * rng.normal(size=nodes[1:-1, 1:-1].shape)
    return nodes


@pytest.mark.parametrize(("make", "ni", "nj"), [(arch, 17, 17), (bump, 9, 21), (arch, 33, 33), (bump, 3, 12)])
def test_near_the_minimum_a_step_leaves_hardly_any_gradient(make, ni, nj) -> None:  # type: ignore[no-untyped-def]
    """Which no step with a wrong Hessian does."""
    nodes = shaken(make(ni, nj), 0.003)
    before = value_and_slope(nodes)[1]
    assert newton(nodes, Weights(), 1) == 1
    newton(nodes, Weights(), 1)
    assert value_and_slope(nodes)[1] < 1e-3 * before


@pytest.mark.parametrize("seed", [1000, 1011, 1020])
def test_a_few_steps_go_most_of_the_way_from_far_off(seed: int) -> None:
    boundary = random_quad(seed, 25, 25)
    assert boundary is not None
    goal = value_and_slope(solve(boundary, tol=1e-6).grid.nodes)[0]
    nodes = tfi(boundary).nodes
    before = value_and_slope(nodes)[0]
    assert newton(nodes, Weights(), 5) > 0
    assert count_folded(nodes) == 0
    assert value_and_slope(nodes)[0] - goal < 0.1 * (before - goal)


def test_where_the_functional_bends_down_steps_still_lower_it() -> None:
    """Between notches the exact Hessian is not positive."""
    boundary = wrench(25, 25)
    nodes = tfi(boundary).nodes
    assert unfold(nodes, Weights(0.0, 0.0))[0]
    values = [value_and_slope(nodes)[0]]
    for _ in range(6):
        assert newton(nodes, Weights(), 1) == 1
        values.append(value_and_slope(nodes)[0])
    assert np.isfinite(values[0])
    assert (np.diff(values) < 0).all()
    assert count_folded(nodes) == 0


@pytest.mark.parametrize("scale", [1e-8, 1e8])
def test_size_place_and_turn_do_not_matter(scale: float) -> None:
    nodes = tfi(bump(13, 17)).nodes
    turn = scale * np.array([[0.6, 0.8], [-0.8, 0.6]])
    moved = np.moveaxis(np.ascontiguousarray(np.moveaxis(nodes @ turn + 2 * scale, -1, 0)), 0, -1)
    newton(nodes, Weights(), 3)
    newton(moved, Weights(), 3)
    np.testing.assert_allclose((moved - 2 * scale) @ turn.T / scale**2, nodes, rtol=0, atol=1e-4)


def test_a_grid_that_stays_folded_is_left_and_planes_without_inner_nodes_are_refused() -> None:
    square = np.stack(np.meshgrid(np.arange(5.0), np.arange(5.0), indexing="ij"))
    square[:, 0, 0] = 2.5
    nodes = np.moveaxis(square, 0, -1)
    assert newton(nodes, Weights(), 3) == 0
    assert stiffness_of(nodes, Weights()) is None
    assert newton(np.moveaxis(np.zeros((2, 2, 5)), 0, -1), Weights(), 3) == 0
    with pytest.raises(ValueError, match="inner nodes"):
        compiled(np.zeros((2, 2, 5)), 1.0, 0.9, 0.0, 1)
