"""The variational functional: its compiled form against numpy, its gradient against differences."""

import numpy as np
import pytest
from functional_reference import energy
from random_quads import random_quad
from solver_shapes import bump, hole, naca, wrench

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import Modes, Stiffness, VariationalDescent
from meshonet.kernels._native import variational_energy as compiled
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.energy.functional import Weights, aspect_of, relief_of
from meshonet.solvers.energy.preconditioner import minimiser


def planes(nodes: Floats) -> Floats:
    return np.ascontiguousarray(np.moveaxis(nodes, -1, 0))


def call(
    nodes: Floats, weights: Weights, epsilon: float, periodic: bool = False
) -> tuple[float, float, Floats]:
    z = planes(nodes)
    gradient = np.empty_like(z)
    terms = aspect_of(nodes, periodic), weights.shape, weights.smoothness
    value, low = compiled(z, *terms, epsilon, periodic, None, gradient)
    return value, low, gradient


CASES = [(bump, 17, 13, 0.0), (wrench, 20, 31, 0.01), (bump, 3, 9, 0.0), (bump, 9, 3, 0.002)]


@pytest.mark.parametrize(("make", "ni", "nj", "epsilon"), CASES)
@pytest.mark.parametrize("weights", [Weights(), Weights(0.0, 0.0), Weights(1.0, 0.1)])
def test_the_compiled_value_is_that_of_numpy(make, ni, nj, epsilon, weights) -> None:  # type: ignore[no-untyped-def]
    nodes = tfi(make(ni, nj)).nodes
    value = call(nodes, weights, epsilon)[0]
    assert value == pytest.approx(energy(nodes, aspect_of(nodes), weights, epsilon), rel=1e-13)


@pytest.mark.parametrize(("make", "ni", "nj", "epsilon"), CASES)
def test_the_gradient_is_the_limit_of_differences(make, ni, nj, epsilon) -> None:  # type: ignore[no-untyped-def]
    nodes = tfi(make(ni, nj)).nodes
    weights, aspect = Weights(), aspect_of(nodes)
    gradient = call(nodes, weights, epsilon)[2]
    rng = np.random.default_rng(ni)
    for _ in range(3):
        move = np.zeros_like(nodes)
        move[1:-1, 1:-1] = rng.normal(size=(ni - 2, nj - 2, 2))
        h = 1e-6
        ahead, behind = (energy(nodes + k * h * move, aspect, weights, epsilon) for k in (1, -1))
        assert (gradient * planes(move)).sum() == pytest.approx((ahead - behind) / (2 * h), rel=1e-6)


@pytest.mark.parametrize("epsilon", [0.0, 0.01])
def test_around_a_body_the_cut_is_like_any_other_line(epsilon: float) -> None:
    nodes = tfi(hole(25, 13)).nodes
    weights, aspect = Weights(), aspect_of(nodes, periodic=True)
    value, _, gradient = call(nodes, weights, epsilon, periodic=True)
    assert value == pytest.approx(energy(nodes, aspect, weights, epsilon, periodic=True), rel=1e-13)
    turned = np.concatenate([nodes[7:-1], nodes[:8]])
    assert call(turned, weights, epsilon, periodic=True)[0] == pytest.approx(value, rel=1e-12)
    move = np.zeros_like(nodes)
    move[:-1, 1:-1] = np.random.default_rng(1).normal(size=(24, 11, 2))
    both = move.copy()
    both[-1] = move[0]
    h = 1e-6
    ahead, behind = (energy(nodes + k * h * both, aspect, weights, epsilon, periodic=True) for k in (1, -1))
    assert (gradient * planes(move)).sum() == pytest.approx((ahead - behind) / (2 * h), rel=1e-6)


def test_corners_at_a_sharp_edge_keep_a_share_of_their_angle_term() -> None:
    nodes = tfi(naca(33, 9)).nodes
    weights, aspect, z = Weights(), aspect_of(nodes, periodic=True), planes(nodes)
    terms = aspect, weights.shape, weights.smoothness, 0.0, True
    share = relief_of(nodes[:, 0])
    assert share[0] == share[-1] < 1e-3
    assert (share[1:-1] == 1).all()
    values, gradients = [], []
    for relief in (None, share):
        gradients.append(np.empty_like(z))
        values.append(compiled(z, *terms, relief, gradients[-1])[0])
    u, v = nodes[1, 0] - nodes[0, 0], nodes[0, 1] - nodes[0, 0]
    back = nodes[0, 0] - nodes[-2, 0]
    angles = [(e @ e) * (v @ v) / (e[0] * v[1] - e[1] * v[0]) ** 2 for e in (u, back)]
    lost = weights.shape * (1 - share[0]) * sum(a**2 for a in angles) / (12 * 32 * 8)
    assert values[0] - values[1] == pytest.approx(lost, rel=1e-10)
    changed = np.argwhere(gradients[0] != gradients[1])
    assert {(int(i), int(j)) for _, i, j in changed} == {(0, 1)}


def test_the_gradient_is_zero_on_the_rim() -> None:
    gradient = call(tfi(bump(17, 13)).nodes, Weights(), 0.0)[2]
    for edge in (gradient[:, 0], gradient[:, -1], gradient[:, :, 0], gradient[:, :, -1]):
        assert not edge.any()


def test_a_square_of_squares_has_value_one_and_no_gradient() -> None:
    nodes = np.stack(np.meshgrid(np.arange(6.0), np.arange(5.0), indexing="ij"), axis=-1)
    value, low, gradient = call(nodes, Weights(), 0.0)
    assert value == pytest.approx(1.0)
    assert low == 1.0
    assert np.abs(gradient).max() < 1e-15


def test_a_folded_grid_is_infinite_unless_regularised() -> None:
    nodes = tfi(bump(9, 9)).nodes
    nodes[4, 4] = nodes[6, 6]
    value, low, _ = call(nodes, Weights(), 0.0)
    assert value == np.inf
    assert energy(nodes, 1.0, Weights()) == np.inf
    assert low < 0
    assert np.isfinite(call(nodes, Weights(), 0.01)[0])


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_scale_turn_and_place_do_not_matter(scale: float) -> None:
    boundary = random_quad(3, 12, 15)
    assert boundary is not None
    nodes = tfi(boundary).nodes
    turn = scale * np.array([[0.6, 0.8], [-0.8, 0.6]])
    moved = call(nodes @ turn + 3 * scale, Weights(), 0.0)[0]
    assert moved == pytest.approx(call(nodes, Weights(), 0.0)[0], rel=1e-9)


def test_a_hessian_that_is_not_positive_steers_nothing() -> None:
    weights, turned = Weights(), np.stack(np.meshgrid(np.arange(5.0), np.arange(5.0), indexing="ij"))
    assert Stiffness(turned, 1.0, weights.shape, weights.smoothness).usable
    bad = Stiffness(np.full_like(turned, np.nan), 1.0, weights.shape, weights.smoothness)
    assert not bad.usable
    with pytest.raises(ValueError, match="Hessian"):
        minimiser(9, 9, False, 1.0, weights).steer(bad, np.ones((7, 3)), np.ones((7, 3)))


def test_transforms_and_splines_of_another_size_are_refused() -> None:
    weights, square = Weights(), np.stack(np.meshgrid(np.arange(5.0), np.arange(5.0), indexing="ij"))
    stiffness = Stiffness(square, 1.0, weights.shape, weights.smoothness)
    with pytest.raises(ValueError, match="splines of another size"):
        minimiser(9, 9, False, 1.0, weights).steer(stiffness, np.ones((7, 3)), np.ones((6, 3)))
    half = Modes(np.ones((1, 1)))
    with pytest.raises(ValueError, match="transforms of another size"):
        VariationalDescent(9, 9, False, (half, half), (half, half), np.ones((2, 2, 2)), 0.0)
