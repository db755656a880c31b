"""Whole numbers of cells under sums that must be equal, against trying all of them."""

from itertools import product

import numpy as np
import pytest

from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.solvers.blocking.arc_counts import nearest_whole
from meshonet.solvers.blocking.chord_counts import ChordWishes, chord_counts, layer_rows, turning_least
from meshonet.solvers.blocking.errors import BlockingError


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
    found = nearest_whole(wanted, np.ones(4), rows)
    best = np.inf
    for tried in product(range(1, 13), repeat=4):
        if all(low <= sum(v * tried[k] for k, v in row.items()) <= high for row, low, high in rows):
            best = min(best, cost(np.array(tried, dtype=float), wanted))
    assert cost(found.astype(float), wanted) <= best * 1.02 + 1e-9


def test_sums_that_cannot_be_equal_are_an_error() -> None:
    with pytest.raises(BlockingError, match="no whole numbers"):
        nearest_whole(np.array([2.0]), np.ones(1), [({0: 2.0}, 3.0, 3.0)])


def test_far_numbers_are_reached() -> None:
    found = nearest_whole(np.array([400.0, 3.0]), np.ones(2), [({0: 1.0, 1: -1.0}, 0.0, 0.0)])
    assert found[0] == found[1]
    assert 20 <= found[0] <= 60, "near the geometric mean, 35"


def wishes(**changes: object) -> ChordWishes:
    given = {
        "chord": np.array([0, 0, 1, 2]),
        "wanted": np.array([8.0, 8.0, 12.3, 3.9]),
        "least": np.array([1, 11, 1, 1]),
        "blocks": np.array([[0, 1], [1, 2]]),
    }
    return ChordWishes(**{**given, **changes})  # type: ignore[arg-type]


def test_a_chord_has_the_mean_of_its_sides_and_at_least_what_one_needs() -> None:
    assert chord_counts(wishes(least=np.ones(4))).tolist() == [8, 12, 4]
    assert chord_counts(wishes()).tolist() == [11, 12, 4]


@pytest.mark.parametrize("cells", [500, 2500, 40000])
def test_total_is_met_within_a_fifth(cells: int) -> None:
    numbers = chord_counts(wishes(), cells)
    assert abs(numbers[0] * numbers[1] + numbers[1] * numbers[2] - cells) < 0.2 * cells


def test_nested_families_have_multiples() -> None:
    numbers = chord_counts(wishes(), 2500, multiple=8)
    assert not np.any(numbers % 8)
    assert numbers[0] >= 11


def test_sides_of_a_period_have_equally_many() -> None:
    numbers = chord_counts(wishes(equal=[([0, 2], [1])]), multiple=2)
    assert numbers[0] + numbers[2] == numbers[1]
    assert not np.any(numbers % 2)


def test_layers_keep_their_rows() -> None:
    numbers = chord_counts(wishes(exact={1: 30}), 2500)
    assert numbers[1] == 30
    assert abs(numbers[0] * 30 + numbers[2] * 30 - 2500) < 500
    with pytest.raises(InputError, match="no multiple of 4"):
        chord_counts(wishes(exact={1: 30}), multiple=4)


def test_a_circle_needs_a_cell_for_each_25_degrees() -> None:
    angle = 2 * np.pi * np.arange(400) / 400
    loop = Loop.of_polygon(np.stack([np.cos(angle), np.sin(angle)], axis=1))
    assert turning_least(loop, 0.0, loop.length) == 15
    assert turning_least(loop, 1.0, 1.0 + loop.length / 4) == 4
    square = Loop.of_polygon(np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]]))
    assert turning_least(square, 0.5, 3.5) == 0, "nodes stand at corners"


def test_rows_fill_the_layers() -> None:
    rows = layer_rows(1.0, 0.01, 1.2)
    heights = 0.01 * 1.2 ** np.arange(rows)
    assert heights.sum() >= 1.0 > heights[:-1].sum()
    assert layer_rows(1.0, 0.1, 1.0) == 10
