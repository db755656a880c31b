"""Winslow's equations in the strip against solutions known in closed form."""

import numpy as np
import pytest

from meshonet.solvers.conformal.strip import (
    COLUMNS,
    MODES,
    across,
    harmonic,
    interpolation,
    modes,
    picard,
    to_columns,
)

THETA = 2 * np.pi * np.arange(COLUMNS) / COLUMNS


def test_derivative_matrices_are_exact_for_smooth_functions() -> None:
    grid = across()
    f = np.exp(-3 * grid.eta)
    np.testing.assert_allclose(grid.d1 @ f, -3 * f, atol=1e-9)
    np.testing.assert_allclose(grid.d2 @ f, 9 * f, atol=1e-5)


def test_kept_eigenvectors_are_those_of_the_second_derivative() -> None:
    grid = across()
    made = grid.vectors * grid.eigenvalues @ grid.inverse
    np.testing.assert_allclose(made, grid.d2[1:-1, 1:-1], atol=1e-12 * np.abs(grid.d2).max())
    np.testing.assert_allclose(grid.vectors @ grid.inverse, np.eye(len(made)), atol=1e-12)


def test_interpolation_reproduces_points_and_smooth_functions() -> None:
    grid = across()
    np.testing.assert_array_equal(
        interpolation(grid.eta[[0, -1]].tobytes()), np.eye(len(grid.eta))[:, [0, -1]]
    )
    eta = np.linspace(0, 1, 101)
    np.testing.assert_allclose(
        np.exp(-40 * grid.eta) @ interpolation(eta.tobytes()), np.exp(-40 * eta), atol=1e-10
    )


@pytest.mark.parametrize("n", [9, 64, 199, 500])
def test_modes_and_columns_are_inverse_for_resolved_functions(n: int) -> None:
    theta = 2 * np.pi * np.arange(n) / n
    c = modes(np.exp(3j * theta) + 0.5 * np.exp(-2j * theta))
    np.testing.assert_allclose(to_columns(c), np.exp(3j * THETA) + 0.5 * np.exp(-2j * THETA), atol=1e-13)


def test_harmonic_extension_of_one_mode_is_its_hyperbolic_sine() -> None:
    T, k, eta = 3.0, 4, np.linspace(0, 1, 11)
    wall, far = np.zeros(2 * MODES + 1, complex), np.zeros(2 * MODES + 1, complex)
    wall[k], far[0] = 0.2, T
    result = harmonic(wall, far, eta)
    np.testing.assert_allclose(result[k], 0.2 * np.sinh(k * T * (1 - eta)) / np.sinh(k * T), atol=1e-14)
    np.testing.assert_allclose(result[0], T * eta, atol=1e-14)


def sheared_solution(T: float, shear: float, size: float, eta: np.ndarray) -> np.ndarray:
    """F of a Winslow solution that is not the harmonic one.

    eta and theta are harmonic functions of w when T eta = Re H and theta = Im H + shear Re H for an analytic
    H; here w = q + size exp(-q) with q = H(w).
    """
    q = T * eta[None, :] * (1 - 1j * shear) + 1j * THETA[:, None]
    return q + size * np.exp(-q) - 1j * THETA[:, None]


@pytest.mark.parametrize(("shear", "size"), [(0.0, 0.3), (0.1, 0.2), (-0.3, 0.3)])
def test_picard_converges_to_the_sheared_conformal_solution(shear: float, size: float) -> None:
    eta = across().eta
    exact = sheared_solution(3.5, shear, size, eta)
    start = harmonic(modes(exact[:, 0]), modes(exact[:, -1]), eta)
    result, changes = picard(start, 25)
    np.testing.assert_allclose(to_columns(result.T).T, exact, atol=2e-7)
    if shear:
        assert np.abs(to_columns(start.T).T - exact).max() > 1e-3, (
            "the harmonic start must differ to prove anything"
        )
    assert changes[-1] < 1e-7
    np.testing.assert_array_equal(result[:, [0, -1]], start[:, [0, -1]])


def test_a_step_that_is_not_finite_is_an_infinite_change_and_the_last() -> None:
    c = harmonic(np.full(2 * MODES + 1, 1e200 + 0j), np.full(2 * MODES + 1, 3e200 + 0j), across().eta)
    assert picard(c, 5)[1] == [np.inf]
