"""Spline matrices against scipy's splines."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from meshonet.solvers.algebraic.resample.spline import bending, places, spline_matrix


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize(("m", "n"), [(4, 9), (9, 100), (33, 65), (17, 17), (12, 5)])
def test_it_is_the_spline_of_scipy(m: int, n: int, periodic: bool) -> None:
    values = np.random.default_rng(m * n).normal(size=(m, 3))
    if periodic:
        values[-1] = values[0]
    spline = CubicSpline(np.arange(m), values, bc_type="periodic" if periodic else "not-a-knot")
    expected = spline(np.linspace(0, m - 1, n))
    np.testing.assert_allclose(spline_matrix(m, n, periodic) @ values, expected, atol=1e-12)


@pytest.mark.parametrize("m", [2, 3, 4])
def test_few_knots_give_the_polynomial_through_them(m: int) -> None:
    x = np.linspace(0, m - 1, 7)
    degree = min(m - 1, 3)
    np.testing.assert_allclose(spline_matrix(m, 7) @ np.arange(m) ** degree, x**degree, atol=1e-13)


def test_knots_keep_their_values() -> None:
    values = np.random.default_rng(0).normal(size=9)
    np.testing.assert_allclose((spline_matrix(9, 33) @ values)[::4], values, atol=1e-15)


def test_the_weights_of_values_and_bends_make_the_matrix() -> None:
    values = np.random.default_rng(1).normal(size=9)
    first, weights = places(9, 40)
    bends = bending(9, False) @ values
    rows = np.stack([values[first], values[first + 1], bends[first], bends[first + 1]], axis=1)
    np.testing.assert_allclose((weights * rows).sum(axis=1), spline_matrix(9, 40) @ values, atol=1e-14)
