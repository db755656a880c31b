"""Panels carry a smooth line to round-off, cover what they say, and leave small grids alone."""

from itertools import pairwise

import numpy as np
import pytest

from meshonet.solvers.conformal.chebyshev import NODES, WORTH, panels


@pytest.mark.parametrize("levels", [200, 800, 3200])
@pytest.mark.parametrize("spread", [0.0, 0.4])
def test_a_line_singular_at_the_wall_is_carried_to_round_off(levels: int, spread: float) -> None:
    eta, height = np.linspace(0.0, 1.0, levels), 4.0
    ends, points, matrix = panels(eta, height, spread, 0, levels)
    assert ends == sorted(set(ends))
    assert ends[-1] == levels
    assert matrix.shape == (NODES, ends[-1] - ends[0])
    for (start, stop), own in zip(pairwise(ends), points.reshape(-1, NODES), strict=True):
        psi, grid = own * height - spread, eta[start:stop] * height - spread
        line = np.exp(psi) + psi**0.3 + 0.1 / psi  # a power and a pole at the wall's outermost point
        result = line @ matrix[:, start - ends[0] : stop - ends[0]]
        np.testing.assert_allclose(result, np.exp(grid) + grid**0.3 + 0.1 / grid, rtol=2e-11)


@pytest.mark.parametrize("levels", [4, 30, 100])
def test_no_panel_costs_more_than_it_saves(levels: int) -> None:
    ends, points, _ = panels(np.linspace(0.0, 1.0, levels), 4.0, 0.1, 0, levels)
    assert all(np.diff(ends) >= WORTH * NODES)
    assert len(points) == NODES * (len(ends) - 1)


def test_levels_outside_the_range_are_left_out() -> None:
    ends = panels(np.linspace(0.0, 1.0, 1000), 4.0, 0.1, 300, 900).ends
    assert (ends[0], ends[-1]) == (300, 900)
