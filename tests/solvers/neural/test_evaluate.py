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
    lift, wall, far, *_ = walls(edges)
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
    found, inner = out[:-1, :, 0] - 1j * out[:-1, :, 1], slice(1, -1)
    np.testing.assert_allclose(found[:, inner], z[:, inner], rtol=1e-11, atol=1e-11)
    np.testing.assert_array_equal(out[-1, inner], out[0, inner])
    np.testing.assert_allclose(grid.at((3, n - 1), 1), (F[:, 1] + 1j * theta)[[3, n - 1]], atol=1e-12)
