"""Of ways that are equally good but for rounding the first is taken."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshonet.geometry.ties import EQUAL, ascending, first_least, less, made_unlike, nearest_whole

VALUES = st.floats(1e-3, 1e3)
NOISE = st.floats(-0.1 * EQUAL, 0.1 * EQUAL)


@given(VALUES, NOISE)
def test_rounding_makes_no_value_less(value, noise):
    assert not less(value, value * (1.0 + noise))
    assert not less(value * (1.0 + noise), value)
    assert less(value * (1.0 - 1e-6), value)


def test_infinity_is_not_less_and_all_else_is_less_than_it():
    assert less(1.0, np.inf)
    assert not less(np.inf, np.inf)
    assert not less(np.nan, np.inf)


@given(st.lists(VALUES, min_size=1, max_size=8), st.lists(NOISE, min_size=8, max_size=8))
def test_the_first_of_equal_items_is_taken_whatever_rounding_did(values, noises):
    exact = first_least(range(len(values)), key=lambda k: values[k])
    assert values[exact] <= min(values) * (1.0 + 2.0 * EQUAL)
    doubled = [*values, *(v * (1.0 + n) for v, n in zip(values, noises, strict=False))]
    assert first_least(range(len(doubled)), key=lambda k: doubled[k]) == exact


def test_without_items_there_is_no_first():
    with pytest.raises(ValueError, match="no items"):
        first_least([], key=float)


@given(st.lists(st.integers(1, 5), min_size=1, max_size=20), st.integers(0, 1000))
def test_equal_values_stay_in_their_order(values, seed):
    noise = 1.0 + 1e-3 * EQUAL * np.random.default_rng(seed).uniform(-1, 1, len(values))
    assert ascending(np.array(values) * noise).tolist() == sorted(range(len(values)), key=lambda k: values[k])


@given(st.integers(1, 10_000), NOISE)
def test_halves_go_down_whatever_rounding_did(whole, noise):
    assert nearest_whole(np.array([(whole + 0.5) * (1.0 + noise)])) == [whole]
    assert nearest_whole(np.array([whole + 0.49, whole + 0.51])).tolist() == [whole, whole + 1.0]


def test_costs_that_are_equal_become_unlike_by_less_than_matters():
    costs = np.full((3, 7), 2.0)
    unlike = made_unlike(costs)
    assert len(np.unique(unlike)) == costs.size
    np.testing.assert_allclose(unlike, costs, rtol=1e-6)
    sums = (unlike.ravel()[:, None] + unlike.ravel())[np.triu_indices(21, 1)]
    assert np.diff(np.sort(sums)).min() > 0.0
