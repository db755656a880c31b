"""The angles that the quad network is taught by."""

import math

import numpy as np
import pytest
import torch

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import per_cell
from meshonet.solvers.neural.fit.quad_figures import excess, extremes


def sheared(n: int, slope: float) -> torch.Tensor:
    """Return a grid (1, n, n) of parallelograms."""
    t = torch.linspace(0.0, 1.0, n, dtype=torch.float64)
    return torch.complex(t[:, None] + slope * t, t + 0.0 * t[:, None])[None]


def test_they_are_those_of_the_quality_report() -> None:
    rng, t = np.random.default_rng(3), np.linspace(0.0, 1.0, 9)
    x, y = (plane + 0.02 * rng.normal(size=(9, 9)) for plane in np.meshgrid(t, t, indexing="ij"))
    least, most = extremes(torch.from_numpy(x + 1j * y)[None])
    grid = Grid.from_nodes(np.stack([x, y], axis=-1))
    np.testing.assert_allclose(np.degrees(most[0].numpy()), per_cell(grid, "max_angle"), rtol=1e-12)
    np.testing.assert_allclose(np.degrees(least[0].numpy()), per_cell(grid, "min_angle"), rtol=1e-12)


def test_skew_beyond_the_goals_counts_and_skew_below_it_does_not() -> None:
    square, skew = sheared(5, 0.0), sheared(5, 1.0)
    mean, widest, folds = excess(skew, square)
    assert float(mean) == pytest.approx(math.pi / 4)
    assert float(widest) == pytest.approx(math.pi / 4)
    assert float(folds) == 0.0
    assert [float(one) for one in excess(square, skew)] == [0.0, 0.0, 0.0]


def test_a_fold_counts_more_the_deeper_it_is_and_unfolding_is_downhill() -> None:
    results = []
    for depth in (0.01, 0.05, 0.09):
        z = sheared(5, 0.0)
        z[0, 2, 2] += (0.125 + depth) * (1 + 1j)  # beyond the diagonal of the next cell
        z.requires_grad_()
        folds = excess(z, sheared(5, 0.0))[2].sum()
        (slope,) = torch.autograd.grad(folds, z)
        assert (slope[0, 2, 2].conj() * (1 + 1j)).real > 0
        results.append(folds.item())
    assert 0.0 < results[0] < results[1] < results[2]


def test_edges_without_length_have_finite_derivatives() -> None:
    z = sheared(5, 0.0)
    z[0, 2, 2] = z[0, 2, 1]
    z.requires_grad_()
    (slope,) = torch.autograd.grad(sum(excess(z, sheared(5, 0.0))).sum(), z)
    assert torch.isfinite(torch.view_as_real(slope)).all()
