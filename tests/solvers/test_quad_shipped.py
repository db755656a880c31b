"""The shipped quad network: golden nodes, folds and angles on domains that it was not trained on."""

import numpy as np
import pytest
from random_quads import random_quad
from solver_shapes import arch

from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded, measure
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.neural.registry import load

GOLDEN = {
    "quad-general": [[0.25623959530059837, 0.23436326840032312], [0.4999999999999999, 0.7090582647742003]],
    "quad-winslow": [[0.24999965394113594, 0.2595612733012841], [0.4999999999999999, 0.8551295846639596]],
}
"""Nodes (16, 16) and (32, 48) of the arch on 65 x 65, without polish."""


@pytest.mark.parametrize("model", list(GOLDEN))
def test_golden_nodes(model: str) -> None:
    nodes = load(model).solve([arch(65, 65)], "off")[0].grid.nodes
    np.testing.assert_allclose(nodes[[16, 32], [16, 48]], GOLDEN[model], rtol=0, atol=1e-9)


def test_polished_grids_are_valid_and_no_worse_than_winslows() -> None:
    drawn = (random_quad(seed, 65, 65) for seed in range(2000, 2012))
    boundaries = [boundary for boundary in drawn if boundary is not None]
    for boundary, solution in zip(boundaries, load("quad-general").solve(boundaries), strict=True):
        assert count_folded(solution.grid.nodes) == 0
        own, other = (measure(grid)["max_angle"] for grid in (solution.grid, winslow(boundary).grid))
        assert own.mean < other.mean
        assert own.max <= other.max + 0.5


def test_the_twin_is_near_winslows_grid_and_a_cycle_brings_it_nearer() -> None:
    drawn = (random_quad(seed, 65, 65) for seed in range(2000, 2012))
    boundaries = [boundary for boundary in drawn if boundary is not None]
    goals = [winslow(boundary, tol=1e-8).grid for boundary in boundaries]
    medians = [
        np.median([compare(s.grid, goal).relative_l2 for s, goal in zip(result, goals, strict=True)])
        for result in (load("quad-winslow").solve(boundaries, steps) for steps in (0, 1))
    ]
    assert medians[0] < 3e-4
    assert medians[1] < 1e-4
