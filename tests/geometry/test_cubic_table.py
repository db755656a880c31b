"""Values of cubic splines through tables: those of the formula in NumPy, bitwise, and cubics exactly."""

import numpy as np
import pytest

from meshonet.geometry.curves.cubic import CubicTable
from meshonet.kernels._native import cubic_values


def formula(table: CubicTable, places: np.ndarray) -> np.ndarray:
    """de Boor's cubics by their values and second derivatives at both ends."""
    x = table.knots
    k = np.clip(np.searchsorted(x, places, side="right") - 1, 0, len(x) - 2)
    shape = (*places.shape, *(1,) * (table.values.ndim - 1))
    h = (x[k + 1] - x[k]).reshape(shape)
    t = (places - x[k]).reshape(shape) / h
    bend = (2.0 - t) * table.bends[k] + (1.0 + t) * table.bends[k + 1]
    start, stop = table.values[k], table.values[k + 1]
    return np.where(t == 1.0, stop, start + t * (stop - start) - t * (1.0 - t) * h**2 / 6.0 * bend)


@pytest.mark.parametrize("shape", [(), (1,), (3,), (2, 3)])
@pytest.mark.parametrize("count", [2, 3, 4, 25])
def test_values_in_the_table_and_beyond_it_are_those_of_the_formula(
    shape: tuple[int, ...], count: int
) -> None:
    draw = np.random.default_rng(count)
    knots = np.cumsum(draw.uniform(0.01, 1.0, count))
    table = CubicTable(draw.normal(size=(count, *shape)), knots)
    places = draw.permutation(np.concatenate([draw.uniform(-1.0, knots[-1] + 1.0, 2 * count), knots, knots]))
    for some in (places, places[::2], places.reshape(2, -1)):
        assert np.array_equal(table(some), formula(table, some))
    assert np.array_equal(table(knots), table.values)


def test_tables_of_another_layout_in_memory_have_the_same_values() -> None:
    values = np.random.default_rng(0).normal(size=(4, 9, 2)).swapaxes(0, 1)
    knots, places = np.arange(18.0)[::2], np.linspace(0.0, 16.0, 7)
    assert np.array_equal(CubicTable(values, knots)(places), CubicTable(values.copy(), knots.copy())(places))


def test_a_table_of_one_knot_is_refused() -> None:
    one = np.zeros((1, 1))
    with pytest.raises(ValueError, match="one knot"):
        cubic_values(one[0], one, one, one[0], one.copy())
