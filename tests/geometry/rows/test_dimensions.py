"""Dimensions of rows in reports, and notes on those that are hardly meant."""

from pathlib import Path

import numpy as np
import pytest
from blade_row import BLADES, HUB, SHROUD, blade_row, profiles, write_row

from meshonet.formats.stack import stack_of
from meshonet.geometry.errors import InputError
from meshonet.geometry.rows.dimensions import doubts, row_dimensions
from meshonet.geometry.rows.frame import AXES, axis_along
from meshonet.geometry.rows.row import Row


def notes(row: Row) -> str:
    return " ".join(doubts(row_dimensions(row)))


def stagger(radius: float) -> float:
    """Of the profiles of the row, in radians."""
    return float(np.radians(20.0 * (radius - 1.0)))


def test_dimensions_are_those_of_the_formulas_of_the_row() -> None:
    made = row_dimensions(blade_row(tip_gap=0.02))
    assert (made.blades, made.pitch) == (BLADES, 360.0 / BLADES)
    assert made.chord == pytest.approx(1.0, rel=0.01)  # of the ellipses, bent on cylinders
    assert made.solidity == pytest.approx(BLADES / (2.0 * np.pi * 2.48), rel=0.02)
    assert made.tip_gap == 0.02
    for edge, way in ((made.leading_edge, -0.5), (made.trailing_edge, 0.5)):
        (x, r), (x_tip, r_tip) = edge["hub"], edge["shroud"]
        assert r == pytest.approx(np.interp(x, *HUB.T), abs=1e-9)
        assert r_tip == pytest.approx(np.interp(x_tip, *SHROUD.T) - 0.02, abs=1e-4)
        assert x == pytest.approx(0.5 + way * np.cos(stagger(r)), abs=0.01)
        assert x_tip == pytest.approx(0.5 + way * np.cos(stagger(r_tip)), abs=0.01)
    across = [
        np.interp(0.5 + way * 0.87, *SHROUD.T) - np.interp(0.5 + way * 0.87, *HUB.T) for way in (-0.5, 0.5)
    ]
    assert made.span == pytest.approx(np.mean(across), rel=2e-3)


def test_lengths_are_in_the_unit_of_the_file(tmp_path: Path) -> None:
    row = stack_of(str(write_row(tmp_path, 'unit = "mm"\ntip_gap = 0.02')))
    assert isinstance(row, Row)
    made = row_dimensions(row)
    assert row.chord == pytest.approx(0.001, rel=0.01)
    assert (made.unit, made.longest_chord) == ("mm", pytest.approx(1000.0 * row.chord))
    size, edges = made.lines.values()
    assert size.startswith(f"{BLADES} blades, 15.65 degrees apart; chord 0.99")
    assert "mm at mid-span" in size
    assert "tip gap 0.02 mm (2.16 %)" in size
    assert edges.startswith("(x, r) in mm: leading (")


def test_places_are_along_the_axis_of_the_file() -> None:
    frame = axis_along(AXES["-z"])
    assert (
        row_dimensions(Row(profiles(), HUB, SHROUD, BLADES, frame=frame))
        .lines["edges"]
        .startswith("(-z, r): ")
    )


@pytest.mark.parametrize(
    ("gap", "words"), [(1e-4, "tip_gap is 0.0108 % of the span"), (0.2, "tip_gap is 21."), (0.02, "")]
)
def test_gaps_in_another_unit_are_doubted(gap: float, words: str) -> None:
    assert words in notes(blade_row(tip_gap=gap))
    assert bool(words) == bool(notes(blade_row(tip_gap=gap)))


@pytest.mark.parametrize(("blades", "words"), [(3, "3 blades have a solidity of 0.19"), (23, "")])
def test_numbers_of_blades_that_leave_a_wide_passage_are_doubted(blades: int, words: str) -> None:
    assert words in notes(Row(profiles(), HUB, SHROUD, blades))
    assert bool(words) == bool(notes(Row(profiles(), HUB, SHROUD, blades)))


def test_a_radius_in_metres_that_no_machine_has_is_doubted() -> None:
    large, small = (
        Row([factor * each for each in profiles()], factor * HUB, factor * SHROUD, BLADES, unit=unit)
        for factor, unit in ((100.0, "m"), (1e-4, "mm"))
    )
    assert "reaches a radius of 296" in notes(large)
    assert "radius of 0.29" in notes(small)


def test_an_unknown_unit_is_refused() -> None:
    with pytest.raises(InputError, match="unit: unit 'yard'; use m, cm"):
        Row(profiles(), HUB, SHROUD, BLADES, unit="yard")
