"""Cells that grow by a constant ratio."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import cells_for_growth, growing_steps, growth_ratio


@settings(max_examples=50, deadline=None)
@given(cells=st.integers(2, 400), log_ratio=st.floats(1e-6, 0.3), first=st.floats(1e-8, 1e3))
def test_the_ratio_is_found_again_from_the_sum(cells: int, log_ratio: float, first: float) -> None:
    sizes = first * np.exp(log_ratio * np.arange(cells))
    assert growth_ratio(first, sizes.sum(), cells) == pytest.approx(np.exp(log_ratio), rel=1e-9)


def test_the_steps_add_up_and_begin_with_the_first() -> None:
    steps = growing_steps(1e-6, 15.0, 119)
    assert steps[0] == 1e-6
    assert steps.sum() == pytest.approx(15.0, rel=1e-12)
    np.testing.assert_allclose(steps[1:] / steps[:-1], steps[1] / steps[0], rtol=1e-13)


@pytest.mark.parametrize("ratio", [1.0, 1.05, 1.2, 2.0])
def test_as_many_cells_as_needed_and_not_one_more(ratio: float) -> None:
    cells = cells_for_growth(0.01, 3.0, ratio)
    assert 0.01 * (ratio ** np.arange(cells)).sum() >= 3.0 - 1e-9
    assert 0.01 * (ratio ** np.arange(cells - 1)).sum() < 3.0


@pytest.mark.parametrize(
    ("first", "length", "cells", "message"),
    [
        (
            1.0,
            5.0,
            6,
            "6 cells, of which the first is 1 high, are longer than the far field is away (5); use a",
        ),
        (
            1e-6,
            10.0,
            5,
            "5 cells from 1e-06 to the far field at 10 would grow by more than 10 each; use more",
        ),
    ],
)
def test_what_does_not_fit_is_said(first: float, length: float, cells: int, message: str) -> None:
    with pytest.raises(InputError) as error:
        growth_ratio(first, length, cells)
    assert message in str(error.value)
