"""The first cell from y+, against the friction law integrated by hand."""

import math

import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.y_plus import first_cell, first_cell_note


def test_it_is_the_height_worked_out_by_hand() -> None:
    # Re_x = 3e6: log10 = 6.4771, Cf = 12.3042^-2.3 = 3.1116e-3, u_tau/U = 0.039444
    assert first_cell(1.0, 6e6) == pytest.approx(1 / (6e6 * 0.039444), rel=1e-3)


def test_it_is_near_the_one_seventh_power_law() -> None:
    for reynolds in (1e6, 6e6, 5e7):
        friction = 0.026 * (0.5 * reynolds) ** (-1 / 7)
        assert first_cell(1.0, reynolds) == pytest.approx(1 / (reynolds * math.sqrt(friction / 2)), rel=0.05)


def test_it_is_proportional_to_y_plus() -> None:
    assert first_cell(30.0, 1e6) == pytest.approx(30 * first_cell(1.0, 1e6), rel=1e-14)


@pytest.mark.parametrize("values", [(0.0, 1e6, 0.5), (1.0, 10.0, 0.5), (1.0, 1e6, 0.0), (1.0, 1e4, 1e-3)])
def test_values_out_of_range_are_refused(values: tuple[float, float, float]) -> None:
    with pytest.raises(InputError, match="use"):
        first_cell(*values)


def test_a_first_cell_names_its_unit_where_that_is_not_the_chord() -> None:
    assert first_cell_note(1e-5, 1e-5, 1e-5, None) == "the first-cell height is 1e-05 at every wall node"
    note = first_cell_note(2.5e-3, 2.5e-3, 2.5e-3, 1.2, chord=250.0)
    height = "the first-cell height is 0.0025 in the unit of the points (1e-05 chords)"
    assert note.startswith(f"{height} at every wall node")
    assert "0.0025 in the unit of the points" in first_cell_note(1e-3, 1e-2, 2.5e-3, 1.2, chord=250.0)
