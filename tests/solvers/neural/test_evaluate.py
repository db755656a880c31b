"""Separable evaluation against the sums and maps written out."""

import numpy as np
import pytest

from meshonet.geometry.arrays import planar_nodes
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.conformal.evaluate import StripGrid
from meshonet.solvers.conformal.fourier_sums import SHARPNESS, TAPS, columns
from meshonet.solvers.conformal.strip import MODES, across, harmonic, interpolation, modes, wavenumbers
from meshonet.solvers.conformal.walls import walls


@pytest.mark.parametrize("designation", ["0012", "4412-sharp"])
@pytest.mark.parametrize(("ni", "nj"), [(60, 50), (301, 50), (150, 400)])
def test_every_node_equals_the_direct_sum_through_the_maps(designation: str, ni: int, nj: int) -> None:
    edges = naca(designation).boundary(Sampling(ni=ni, nj=nj))
    lift, wall, far, *_ = walls(edges)
    n, eta = ni - 1, np.linspace(0, 1, nj)
    c = harmonic(modes(wall), modes(far), across().eta)
    out = planar_nodes(ni, nj)
    grid = StripGrid(c, wall, far, eta)
    assert grid.fill(lift, out)

    theta = 2 * np.pi * np.arange(n) / n
    F = np.exp(1j * np.outer(theta, wavenumbers())) @ (c @ interpolation(eta.tobytes()))
    rest = np.fft.fft(wall)
    k = np.minimum(np.arange(n), n - np.arange(n))
    rest[k <= min(MODES, (n - 1) // 2)] = 0
    T = (far.mean() - wall.mean()).real
    F += np.fft.ifft(rest[:, None] * np.exp(-np.outer(k, eta) * T), axis=0)
    z = lift.to_plane(F + 1j * theta[:, None])
    result, inner = out[:-1, :, 0] - 1j * out[:-1, :, 1], slice(1, -1)
    np.testing.assert_allclose(result[:, inner], z[:, inner], rtol=1e-11, atol=1e-11)
    np.testing.assert_array_equal(out[-1, inner], out[0, inner])
    np.testing.assert_allclose(grid.at((3, n - 1), 1), (F[:, 1] + 1j * theta)[[3, n - 1]], atol=1e-12)


def test_a_grid_that_is_not_finite_is_told() -> None:
    edges = naca("0012").boundary(Sampling(ni=60, nj=200))
    lift, wall, far, *_ = walls(edges)
    for level in (1, 30):
        c = harmonic(modes(wall), modes(far), across().eta)
        c[3, level] = np.nan
        assert not StripGrid(c, wall, far, np.linspace(0, 1, 200)).fill(lift, planar_nodes(60, 200))


@pytest.mark.parametrize(("count", "highest"), [(1, 0), (5, 63), (17, 100), (8, 300)])
def test_columns_are_the_sums_of_the_modes_over_the_window_s_transform(count: int, highest: int) -> None:
    rng = np.random.default_rng(3)
    values = rng.standard_normal((2, count, 2 * highest + 1))
    modes_ = values[0] + 1j * values[1]
    result = columns(modes_)
    k = np.concatenate([np.arange(highest + 1), np.arange(-highest, 0)])
    steps = len(result)
    assert steps >= 4 * highest + 4
    x = np.linspace(-1, 1, 20001)
    window = np.exp(SHARPNESS * (np.sqrt(np.maximum(1 - x * x, 0)) - 1))
    gain = np.trapezoid(np.cos(np.pi * TAPS / steps * np.abs(k)[:, None] * x) * window, x) * TAPS / 2
    sums = np.exp(2j * np.pi / steps * np.outer(np.arange(steps), k)) @ (modes_ / gain).T
    got = result[:, 0, :count] + 1j * result[:, 1, :count]
    np.testing.assert_allclose(got, sums, atol=1e-9 * np.abs(sums).max())
    assert not result[:, :, count:].any()
