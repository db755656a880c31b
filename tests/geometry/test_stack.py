"""Sections placed in space, and what lies between them."""

import numpy as np
import pytest

from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.section import Section, placed
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.circle import Circle

EDGES = np.array([[0.0, 0.0], [1.0, 0.0], [0.25, 0.0]])
"""Leading edge, trailing edge and quarter chord."""


def section(**values: float) -> Section:
    return Section(naca("0012"), values.pop("chord", 1.0), values.pop("z", 0.0), **values)


def test_a_twist_raises_the_nose_about_the_quarter_chord():
    nose, tail, quarter = placed(EDGES, section(chord=2.0, x=3.0, y=1.0, twist=30.0).placement)
    assert quarter == pytest.approx([3.5, 1.0])
    assert nose == pytest.approx([3.5 - 0.5 * np.cos(np.pi / 6), 1.0 + 0.5 * 0.5])
    assert tail == pytest.approx([3.5 + 1.5 * np.cos(np.pi / 6), 1.0 - 1.5 * 0.5])


def test_the_place_of_the_twist_can_be_chosen():
    nose = placed(EDGES, section(twist=90.0, about=(1.0, 0.0)).placement)[0]
    assert nose == pytest.approx([1.0, 1.0])


def test_a_section_drawn_from_0_to_1_is_taken_as_it_is_and_others_are_scaled_to_it():
    assert section().frame == (pytest.approx([0.0, 0.0]), 1.0)
    origin, length = Section(Circle(2.0), 1.0, 0.0).frame
    assert (origin.tolist(), length) == ([-2.0, 0.0], 4.0)


def test_between_sections_twisted_apart_the_chord_stays_as_long():
    stack = Stack((section(), section(z=2.0, twist=90.0)))
    nose, tail, _ = stack.lofted(np.stack([EDGES, EDGES]), np.array([1.0]))[0]
    assert np.linalg.norm(tail - nose) == pytest.approx(1.0)
    assert nose[2] == tail[2] == 1.0


def test_sections_are_met_bitwise():
    stack = Stack((section(), section(z=1.0, x=0.3, chord=0.7), section(z=4.0, x=1.1, chord=0.3)))
    unit = np.stack([EDGES, EDGES + 0.01, EDGES - 0.02])
    for between in ("linear", "smooth"):
        made = Stack(stack.sections, between=between).lofted(unit, stack.z)  # type: ignore[arg-type]
        for k, part in enumerate(stack.sections):
            assert np.array_equal(made[k, :, :2], placed(unit[k], part.placement))


def test_smooth_values_overshoot_nowhere_and_have_no_kink():
    x, values = np.array([0.0, 1.0, 2.0, 5.0]), np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.2], [4.0, 0.9]])
    fine = np.linspace(0.0, 5.0, 2001)
    out = monotone_cubic(x, values, fine)
    for k in range(3):
        inside = (fine >= x[k]) & (fine <= x[k + 1])
        low, high = np.minimum(values[k], values[k + 1]), np.maximum(values[k], values[k + 1])
        assert (out[inside] >= low - 1e-12).all()
        assert (out[inside] <= high + 1e-12).all()
    slope = np.diff(out, axis=0) / np.diff(fine)[:, None]
    assert np.abs(np.diff(slope, axis=0)).max() < 0.02


@pytest.mark.parametrize(
    ("made", "problem"),
    [
        (lambda: Stack((section(),)), "1 sections"),
        (lambda: Stack((section(), section())), "z is 0 behind 0"),
        (lambda: Stack((section(), section(z=1.0)), tip="pointed"), "tip 'pointed' is not known"),
        (lambda: section(chord=0.0), "a chord of 0"),
        (lambda: section(x=np.inf), "x is inf"),
        (lambda: Stack((section(), section(z=1.0)), kind="blade").with_tip("flat"), "a blade has no tip"),
    ],
)
def test_what_is_no_stack_is_refused(made, problem):
    with pytest.raises(InputError) as refusal:
        made()
    assert problem in str(refusal.value)
