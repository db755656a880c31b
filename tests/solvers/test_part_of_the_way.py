"""A folded answer is taken part of the way, where that is valid."""

import numpy as np
import pytest
import torch
from random_quads import random_quad

from meshonet.geometry.arrays import Complexes
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.neural.differentiable import QuadGrids
from meshonet.solvers.neural.quad.coarse_grids import share
from meshonet.solvers.neural.registry import load


def pushed(by: float) -> Complexes:
    """Return a grid (9, 9) of squares, one node of which is moved by so many cells along the diagonal."""
    t = np.linspace(0.0, 8.0, 9)
    nodes = t[:, None] + 1j * t
    nodes[4, 4] += by * (1.0 + 1.0j)
    return nodes


@pytest.mark.parametrize(("by", "part"), [(0.4, 1.0), (0.51, 0.95), (0.55, 0.9), (0.6, 0.8), (0.9, 1.0)])
def test_the_first_share_without_folds_is_taken_or_all(by: float, part: float) -> None:
    assert share(pushed(0.0), pushed(by)) == part  # a cell folds when its corner passes the diagonal, at half


@pytest.mark.parametrize("seed", [20019, 20192])
def test_grids_that_would_fold_are_valid_in_torch_too(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    boundary = random_quad(seed, 65, 65)
    assert boundary is not None
    (result,) = load("quad-general").solve([boundary], "off")
    assert count_folded(result.grid.nodes) == 0
    sides = (boundary.south, boundary.north, boundary.west, boundary.east)
    (nodes,) = QuadGrids()(*(torch.from_numpy(np.ascontiguousarray(side))[None] for side in sides)).numpy()
    assert np.abs(nodes - result.grid.nodes).max() < 1e-12 * np.ptp(result.grid.nodes)
    monkeypatch.setattr("meshonet.solvers.neural.quad.coarse_grids.share", lambda *_: 1.0)
    assert count_folded(load("quad-general").solve([boundary], "off")[0].grid.nodes) > 0
