"""From interpolated grids towards Winslow's by Picard steps."""

import numpy as np
import pytest
from relabelling import relabelled

from meshonet.geometry.arrays import Complexes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.neural.quad.picard import approach
from meshonet.solvers.neural.quad.symmetry import ORDER


def conformal(n: int, bend: float) -> Complexes:
    """Return (n, n) nodes of a square under a conformal map, of which Winslow's equations are true."""
    t = np.linspace(-0.5, 0.5, n)
    w = t[:, None] + 1j * t
    return np.asarray(w + bend * w**2 - 0.3j * bend * w**3)


def interpolated(z: Complexes) -> Complexes:
    nodes = np.stack([z.real, z.imag], axis=-1)
    grid = tfi(Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1], "quad")).nodes
    return np.asarray(grid[..., 0] + 1j * grid[..., 1])


def solved(z: Complexes) -> Complexes:
    nodes = np.stack([z.real, z.imag], axis=-1)
    grid = solve(Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1], "quad"), tol=1e-12).grid.nodes
    return np.asarray(grid[..., 0] + 1j * grid[..., 1])


def wild(around: bool = False) -> Complexes:
    """Return interpolated grids (5, n, n), or strips, of uneven edges, some of them folded."""
    rng = np.random.default_rng(3)
    if around:
        t, s = np.linspace(0.0, 2 * np.pi, 33)[:, None], np.linspace(0.0, 1.0, 17)
        waves = [k * np.sin(2 * t + k) * (1 - s) + 0.3 * k * np.cos(t) * s for k in (0.1, 0.3, 0.5)]
        return np.asarray(np.stack([t + 1j * (2 * s + wave) for wave in waves]))
    return np.stack([interpolated(conformal(17, k) + 0.1 * k * rng.normal(size=17)) for k in (0.1, 0.3, 0.5)])


@pytest.mark.parametrize("bend", [0.2, 0.5])
def test_steps_go_to_the_solution_of_winslows_equations(bend: float) -> None:
    exact = conformal(33, bend)
    start = interpolated(exact)
    near, _ = approach(start[None], np)
    second_order = np.abs(solved(exact) - exact).max()
    assert np.abs(near[0] - exact).max() < 0.4 * second_order
    assert second_order < 0.05 * np.abs(start - exact).max()


@pytest.mark.parametrize("bend", [0.2, 0.5])
def test_the_last_step_tells_how_far_off_the_grid_may_be(bend: float) -> None:
    exact = conformal(33, bend)
    near, step = approach(interpolated(exact)[None], np)
    assert 0 < np.abs(step).max() < 10 * np.abs(near[0] - exact).max()


@pytest.mark.parametrize("harmonic", [True, False])
@pytest.mark.parametrize("around", [False, True])
def test_the_compiled_steps_are_those_of_the_formulas(around: bool, harmonic: bool) -> None:
    assert_compiled(wild(around), around, harmonic)
    assert_compiled(wild(around)[:, :, ::2], around, harmonic)


@pytest.mark.parametrize("around", [False, True])
@pytest.mark.parametrize("counts", [(6, 6), (7, 10), (12, 9), (18, 17), (35, 18)])
def test_the_compiled_steps_are_those_of_the_formulas_for_any_counts(
    counts: tuple[int, int], around: bool
) -> None:
    m, n = counts
    along, across = np.linspace(0.0, 2 * np.pi if around else 1.0, m)[:, None], np.linspace(0.0, 1.0, n)
    assert_compiled((along + 1j * across + 0.1 * np.sin(along + 2.0 * across) * (1.0 + 0.5j))[None], around)


def assert_compiled(z: Complexes, around: bool, harmonic: bool = True) -> None:
    torch = pytest.importorskip("torch")
    tensors = approach(torch.from_numpy(np.ascontiguousarray(z)), torch, around, harmonic=harmonic)
    for mine, its in zip(approach(z, np, around, harmonic=harmonic), tensors, strict=True):
        np.testing.assert_allclose(its.numpy(), mine, rtol=0, atol=1e-12)


def test_extrapolated_steps_get_nearer_than_as_many_plain_ones() -> None:
    """In a sheared and bent domain, by the mean square of the last step, which is zero at the solution."""
    t = np.linspace(0.0, 1.0, 33)[:, None]
    start, _ = approach(interpolated(t + (1.0 + 1j) * t.T + 0.2j * np.sin(2 * np.pi * t))[None], np)
    _, step = approach(start, np, steps=3, harmonic=False)
    for _ in range(3):
        start, last = approach(start, np, steps=1, harmonic=False)
    assert (np.abs(step) ** 2).mean() < 0.5 * (np.abs(last) ** 2).mean()


@pytest.mark.parametrize("around", [False, True])
def test_steps_can_go_on_from_where_they_ended(around: bool) -> None:
    z = wild(around)
    half, _ = approach(z, np, around, steps=2)
    result = approach(half, np, around, steps=1, harmonic=False)
    for one, other in zip(result, approach(z, np, around, steps=3), strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-14)


@pytest.mark.parametrize("around", [False, True])
def test_edges_stay_as_they_are(around: bool) -> None:
    z = wild(around)
    near, step = approach(z, np, around)
    for side in (np.s_[..., 0], np.s_[..., -1]):
        np.testing.assert_array_equal(near[side], z[side])
        assert not step[side].any()
    if around:
        np.testing.assert_allclose(near[:, -1] - near[:, 0], 2 * np.pi, atol=1e-14)
        np.testing.assert_array_equal(step[:, -1], step[:, 0])
    else:
        np.testing.assert_array_equal(near[:, [0, -1]], z[:, [0, -1]])


@pytest.mark.parametrize("element", range(ORDER))
def test_a_relabelled_domain_has_the_relabelled_grid(element: int) -> None:
    z = wild()
    for mine, moved in zip(approach(z, np), approach(relabelled(z, element), np), strict=True):
        np.testing.assert_allclose(moved, relabelled(mine, element), rtol=0, atol=1e-12)


def test_a_strip_that_begins_further_round_has_the_same_grid_from_there() -> None:
    z = wild(around=True)
    moved = np.concatenate([z[:, 5:-1], z[:, :6] + 2 * np.pi], axis=1)
    near, other = approach(z, np, around=True)[0], approach(moved, np, around=True)[0]
    np.testing.assert_allclose(other[:, :-5], near[:, 5:], rtol=0, atol=1e-12)


def test_a_step_that_grows_or_is_no_number_is_not_taken() -> None:
    rng = np.random.default_rng(0)
    vanishing = wild() * 1e-160  # squares of its differences are zero
    torn = wild() + rng.normal(size=wild().shape)
    for given in (vanishing, torn):
        near, step = approach(given, np)
        assert np.isfinite(near).all()
        assert np.isfinite(step).all()
        assert np.abs(near).max() < 10 * np.abs(given).max()
