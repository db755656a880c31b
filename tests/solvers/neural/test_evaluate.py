"""Separable evaluation against the sums and maps written out."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.arrays import planar_nodes
from geometry.naca import naca
from geometry.sampling import Sampling
from solvers.neural.evaluate import StripGrid
from solvers.neural.operator import walls
from solvers.neural.strip import MODES, across, harmonic, interpolation, modes, wavenumbers


@pytest.mark.parametrize("designation", ["0012", "4412-sharp"])
@pytest.mark.parametrize(("ni", "nj"), [(60, 50), (301, 50), (150, 400)])
def test_every_node_equals_the_direct_sum_through_the_maps(designation: str, ni: int, nj: int) -> None:
    edges = naca(designation).boundary(Sampling(ni=ni, nj=nj))
    lift, wall, far, _, _ = walls(edges)
    n, eta = ni - 1, np.linspace(0, 1, nj)
    c = harmonic(modes(wall), modes(far), across().eta)
    out = planar_nodes(ni, nj)
    grid = StripGrid(c, wall, far, eta)
    grid.fill(lift, out)

    theta = 2 * np.pi * np.arange(n) / n
    F = np.exp(1j * np.outer(theta, wavenumbers())) @ (c @ interpolation(eta))
    rest = np.fft.fft(wall)
    k = np.minimum(np.arange(n), n - np.arange(n))
    rest[k <= min(MODES, (n - 1) // 2)] = 0
    T = (far.mean() - wall.mean()).real
    F += np.fft.ifft(rest[:, None] * np.exp(-np.outer(k, eta) * T), axis=0)
    z = lift.to_plane(F + 1j * theta[:, None])
    np.testing.assert_allclose(out[:-1, :, 0] - 1j * out[:-1, :, 1], z, rtol=1e-9, atol=2e-9)
    np.testing.assert_array_equal(out[-1], out[0])
    for i, j in ((0, 0), (3, 1), (n // 2, 20), (n - 1, nj - 1)):
        assert abs(grid.at(i, j) - F[i, j] - 1j * theta[i]) < 2e-9


def test_the_wall_comes_out_where_it_went_in() -> None:
    edges = naca("2412").boundary(Sampling(ni=400, nj=20))
    lift, wall, far, z, _ = walls(edges)
    c = harmonic(modes(wall), modes(far), across().eta)
    out = planar_nodes(400, 20)
    StripGrid(c, wall, far, np.linspace(0, 1, 20)).fill(lift, out)
    np.testing.assert_allclose(out[:-1, 0, 0] - 1j * out[:-1, 0, 1], z, atol=1e-13)
