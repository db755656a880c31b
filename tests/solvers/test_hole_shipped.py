"""The shipped network for bodies: golden nodes, folds and angles on bodies that it was not trained on."""

import numpy as np
import pytest

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.bodies import boundary
from meshonet.geometry.families.family import family
from meshonet.geometry.quality.compare import compare
from meshonet.geometry.quality.measure import count_folded, measure
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.neural.registry import load

GOLDEN = {
    "hole-o": [[0.4028057080448652, -0.02293693289481455], [-0.6803300878792513, 0.5814152731912777]],
    "hole-winslow": [[0.41449626625239167, -0.01712330160827319], [-0.5697570031194117, 0.5759273644781288]],
}
"""Nodes (5, 8) and (40, 20) of the hole at 0.2 on 65 x 33, without polish."""


def bodies() -> list[Boundary]:
    return [boundary(np.random.default_rng([2000, k]), 97, 49) for k in range(10)]


def hole(height: float, ni: int = 101, nj: int = 101) -> Boundary:
    return family("hole").boundary(height, ni, nj)


@pytest.mark.parametrize("model", list(GOLDEN))
def test_golden_nodes(model: str) -> None:
    nodes = load(model).solve([hole(0.2, 65, 33)], "off")[0].grid.nodes
    np.testing.assert_allclose(nodes[[5, 40], [8, 20]], GOLDEN[model], rtol=0, atol=1e-9)


def test_polished_grids_are_valid_and_nearer_to_right_angles_than_winslows() -> None:
    edges = bodies()
    results = [solution.grid for solution in load("hole-o").solve(edges)]
    assert sum(count_folded(grid.nodes) for grid in results) == 0
    own, other = (
        np.array([[measure(grid)["max_angle"].max, measure(grid)["max_angle"].mean] for grid in grids])
        for grids in (results, [winslow(one).grid for one in edges])
    )
    assert (own[:, 1] < other[:, 1]).mean() >= 0.9
    assert np.median(own[:, 1]) < 97.0 < np.median(other[:, 1])
    assert np.median(own[:, 0]) < np.median(other[:, 0])


def test_the_papers_hole_is_nearer_to_winslows_grid_than_the_papers_model_and_nearest_with_polish() -> None:
    edges = [hole(height) for height in (-0.35, 0.0, 0.2)]
    goals = [winslow(one, tol=1e-8).grid for one in edges]
    worst = []
    for polish in (0, 2):
        results = [solution.grid for solution in load("hole-winslow").solve(edges, polish)]
        assert sum(count_folded(grid.nodes) for grid in results) == 0
        worst.append(max(compare(grid, goal).relative_l2 for grid, goal in zip(results, goals, strict=True)))
    assert worst[0] < 3e-2  # MeshONet: 3.2e-2
    assert worst[1] < 2e-3
