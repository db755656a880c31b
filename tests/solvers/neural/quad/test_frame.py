"""The compiled frame of grids against the one in numpy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import add_answers, frame_put_back, frame_take_out
from meshonet.solvers.neural.quad.encoding import frame


def grids() -> Floats:
    """Return the planes (3, 2, 9, 6) of uneven grids off the origin."""
    noise = np.random.default_rng(0).normal(size=(3, 2, 9, 6))
    places = np.stack(np.meshgrid(np.linspace(0, 3, 9), np.linspace(0, 2, 6), indexing="ij"))
    return np.asarray(places + 0.1 * noise + 40.0)


def taken_out(planes: Floats) -> tuple[Floats, Floats]:
    unit, factors = np.empty_like(planes), np.empty((len(planes), 2))
    frame_take_out(planes, unit, factors)
    return unit, factors


def test_what_is_taken_out_is_the_frame_in_numpy() -> None:
    planes = grids()
    z = planes[:, 0] + 1j * planes[:, 1]
    middle, factor = (value[:, None, None] for value in frame(z, np))
    unit, factors = taken_out(planes)
    np.testing.assert_allclose(unit[:, 0] + 1j * unit[:, 1], (z - middle) * factor, rtol=0, atol=1e-13)
    np.testing.assert_allclose(factors[:, 0] + 1j * factors[:, 1], factor[:, 0, 0], rtol=1e-13)


def test_moves_are_put_back_at_the_own_size_and_nothing_else_changes() -> None:
    planes = grids()
    unit, factors = taken_out(planes)
    moved, found = unit.copy(), planes.copy()
    moved[:, 0, 4, 3] += 0.25
    frame_put_back(found, moved, unit, factors)
    by = 0.25 / (factors[:, 0] + 1j * factors[:, 1])
    change = found - planes
    np.testing.assert_allclose(change[:, 0, 4, 3] + 1j * change[:, 1, 4, 3], by, rtol=1e-11)
    change[:, :, 4, 3] = 0.0
    assert not change.any()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_answers_of_a_head_are_added_times_the_rim(dtype: Any) -> None:
    planes, rng = grids(), np.random.default_rng(1)
    answers, rim = rng.normal(size=(3, 9, 6, 2, 2)).astype(dtype), rng.uniform(size=(9, 6))
    found = planes.copy()
    add_answers(found, answers, 1, rim)
    expected = planes + np.moveaxis(answers[..., 1, :].astype(float) * rim[..., None], -1, 1)
    np.testing.assert_allclose(found, expected, rtol=1e-15)


def test_arrays_that_do_not_fit_are_refused() -> None:
    planes, unit, factors = grids(), grids(), np.empty((3, 2))
    with pytest.raises(ValueError, match="is needed"):
        frame_take_out(planes, unit[:, :, 1:].copy(), factors)
    with pytest.raises(ValueError, match="is needed"):
        frame_take_out(planes[:, :1].copy(), unit[:, :1].copy(), factors)
    with pytest.raises(ValueError, match="is needed"):
        frame_take_out(planes, unit, factors[1:])
    with pytest.raises(ValueError, match="is needed"):
        frame_put_back(planes, unit, unit, factors[:, :1].copy())
    with pytest.raises(ValueError, match="is needed"):
        add_answers(planes, np.zeros((3, 9, 5, 2, 2)), 1, np.ones((9, 6)))
    with pytest.raises(ValueError, match="no such head"):
        add_answers(planes, np.zeros((3, 9, 6, 2, 2)), 2, np.ones((9, 6)))
