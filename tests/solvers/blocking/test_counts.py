"""Whole numbers of cells under sums that must be equal, against trying all of them."""

from itertools import product

import numpy as np
import pytest

from meshonet.geometry.errors import SolverError
from meshonet.solvers.whole_numbers import whole_numbers


def cost(numbers: np.ndarray, wanted: np.ndarray) -> float:
    size = np.maximum(wanted, 0.5)
    return float((numbers / size + size / numbers).sum())


@pytest.mark.parametrize("seed", range(12))
def test_no_other_whole_numbers_are_nearer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    wanted = rng.uniform(0.2, 5.0, 4)
    signs = rng.choice([-1.0, 1.0], 3)
    rows = [({0: 1.0, 1: 1.0, 2: -1.0}, 0.0, 0.0), ({1: 1.0, 3: -1.0}, -1.0, 1.0)]
    if signs.sum() > 0:
        rows.append(({0: 1.0, 3: 1.0}, 4.0, np.inf))
    result = whole_numbers(wanted, np.ones(4), rows)
    best = np.inf
    for tried in product(range(1, 13), repeat=4):
        if all(low <= sum(v * tried[k] for k, v in row.items()) <= high for row, low, high in rows):
            best = min(best, cost(np.array(tried, dtype=float), wanted))
    assert cost(result.astype(float), wanted) <= best * 1.02 + 1e-9


def test_sums_that_cannot_be_equal_are_an_error() -> None:
    with pytest.raises(SolverError, match="no whole numbers"):
        whole_numbers(np.array([2.0]), np.ones(1), [({0: 2.0}, 3.0, 3.0)])


def test_far_numbers_are_reached() -> None:
    result = whole_numbers(np.array([400.0, 3.0]), np.ones(2), [({0: 1.0, 1: -1.0}, 0.0, 0.0)])
    assert result[0] == result[1]
    assert 20 <= result[0] <= 60, "near the geometric mean, 35"
