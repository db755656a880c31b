"""Panels carry a smooth line to round-off, cover what they say, and leave small grids alone."""

from __future__ import annotations

import numpy as np
import pytest

from meshonet.solvers.conformal.chebyshev import NODES, WORTH, panels


@pytest.mark.parametrize("levels", [200, 800, 3200])
@pytest.mark.parametrize("spread", [0.0, 0.4])
def test_a_line_singular_at_the_wall_is_carried_to_round_off(levels: int, spread: float) -> None:
    eta, height = np.linspace(0.0, 1.0, levels), 4.0
    found = panels(eta, height, spread, 0, levels)
    for panel in found:
        psi, grid = panel.eta * height - spread, eta[panel.start : panel.stop] * height - spread
        line = np.exp(psi) + psi**0.3 + 0.1 / psi  # a power and a pole at the wall's outermost point
        np.testing.assert_allclose(line @ panel.matrix, np.exp(grid) + grid**0.3 + 0.1 / grid, rtol=2e-11)
    assert [panel.stop for panel in found[:-1]] == [panel.start for panel in found[1:]]
    assert found[-1].stop == levels


@pytest.mark.parametrize("levels", [4, 30, 100])
def test_no_panel_costs_more_than_it_saves(levels: int) -> None:
    for panel in panels(np.linspace(0.0, 1.0, levels), 4.0, 0.1, 0, levels):
        assert panel.stop - panel.start >= WORTH * NODES


def test_levels_outside_the_range_are_left_out() -> None:
    found = panels(np.linspace(0.0, 1.0, 1000), 4.0, 0.1, 300, 900)
    assert (found[0].start, found[-1].stop) == (300, 900)
