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


def steep(cant, last="panel", **values) -> Stack:
    """Return a wing whose last panel has 70 degrees of dihedral."""
    rise = 0.2 * np.tan(np.radians(70.0))
    ends = section(z=2.2, y=rise, cant=last)
    return Stack((section(), section(z=2.0, cant=cant), ends), **values)


def test_a_canted_section_is_turned_about_the_chord_line_and_keeps_its_size():
    unit = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.06], [0.3, -0.06]])
    stack = Stack((section(), section(z=2.0, y=1.0, x=0.5, cant=30.0)))
    nose, tail, upper, lower = stack.lofted(np.stack([unit, unit]), np.array([2.0]))[0]
    assert nose == pytest.approx([0.5, 1.0, 2.0])
    assert tail == pytest.approx([1.5, 1.0, 2.0])
    assert upper - lower == pytest.approx([0.0, 0.12 * np.cos(np.pi / 6), -0.12 * np.sin(np.pi / 6)])


def test_a_panel_between_sections_with_its_cant_is_as_thick_as_they_are():
    unit = np.repeat(np.array([[[0.3, 0.06], [0.3, -0.06]]]), 3, axis=0)
    normal = np.array([0.0, np.cos(np.radians(70.0)), -np.sin(np.radians(70.0))])
    upper, lower = steep(70.0).lofted(unit, np.array([2.1]))[0]
    assert (upper - lower) @ normal == pytest.approx(0.12)
    upper, lower = steep(0.0, 0.0).lofted(unit, np.array([2.1]))[0]
    assert (upper - lower) @ normal == pytest.approx(0.12 * np.cos(np.radians(70.0)))


def test_the_cant_of_panels_is_the_mean_of_those_beside_a_section_and_0_in_planes_of_symmetry():
    assert np.degrees(steep("panel").cants) == pytest.approx([0.0, 35.0, 70.0])
    assert np.degrees(steep("panel", tip="open").cants) == pytest.approx([0.0, 35.0, 0.0])


def test_a_note_says_how_much_thinner_a_steep_panel_is_than_its_sections():
    (note,) = steep(0.0, 0.0).notes
    assert note.startswith("between z=2 and 2.2 the wing is 34 % as thick as its sections")
    assert note.endswith('cant = "panel" turns them')
    assert steep("panel").notes == ()
    assert Stack((section(), section(z=2.0, y=0.7))).notes == ()


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
        (lambda: section(cant=91.0), "cant is 91.0"),
        (lambda: section(cant="up"), "cant is 'up'"),
        (lambda: Stack((section(cant=5.0), section(z=1.0))), "5 degrees, and the section lies in a plane of"),
        (lambda: Stack((section(), section(z=1.0, cant=5.0)), kind="blade"), "the sections of a blade are"),
        (lambda: Stack((section(), section(z=1.0)), kind="blade").with_tip("flat"), "a blade has no tip"),
    ],
)
def test_what_is_no_stack_is_refused(made, problem):
    with pytest.raises(InputError) as refusal:
        made()
    assert problem in str(refusal.value)
