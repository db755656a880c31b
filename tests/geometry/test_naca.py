import numpy as np
import pytest
from sections import farthest

from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.naca import naca, naca_points, thickness


def test_ordinates_are_those_of_the_reports():
    """NACA Report 460, table of the 0012 (percent of chord); Report 537, ordinates of the 23012 at 30 %."""
    x = np.array([1.25, 5, 20, 50, 80, 95]) / 100
    np.testing.assert_allclose(
        100 * thickness(x, 0.12), [1.894, 3.555, 5.738, 5.294, 2.623, 0.807], atol=6e-4
    )
    curve = naca("23012").curve.at(np.linspace(0, naca("23012").curve.length, 40_001))
    upper, lower = curve[20_000:], curve[:20_000]
    for at, top, bottom in ((0.30, 0.0755, -0.0446), (0.05, 0.0491, -0.0226), (0.80, 0.0308, -0.0216)):
        assert upper[np.argmin(np.abs(upper[:, 0] - at)), 1] == pytest.approx(top, abs=3e-4)
        assert lower[np.argmin(np.abs(lower[:, 0] - at)), 1] == pytest.approx(bottom, abs=3e-4)


@pytest.mark.parametrize(
    ("designation", "camber", "place"), [("2412", 0.02, 0.4), ("6309", 0.06, 0.3), ("23012", 0.0184, 0.15)]
)
def test_camber_is_as_large_and_where_the_digits_say(designation, camber, place):
    points = naca_points(designation, 2001)
    upper, lower = points[:2001][::-1], points[2000:]
    middle = 0.5 * (upper + lower)
    k = int(np.argmax(middle[:, 1]))
    assert middle[k, 1] == pytest.approx(camber, rel=0.01)
    assert middle[k, 0] == pytest.approx(place, abs=0.01)


@pytest.mark.parametrize("designation", ["0006", "2412", "4421-sharp", "23012", "23112-sharp", "44018"])
def test_curve_is_the_formula(designation):
    airfoil = naca(designation)
    curve = airfoil.curve
    dense = curve.at(np.union1d(np.linspace(0, curve.length, 30_001), curve.knots))
    assert farthest(naca_points(designation, 100), dense) < 2e-6  # most where the mean line's curvature jumps
    assert airfoil.chord == pytest.approx(1, abs=4e-3)


@pytest.mark.parametrize("designation", ["21012", "22012", "23012", "25012", "22112", "23112", "25112"])
def test_five_digit_mean_lines_have_the_lift_and_moment_they_were_made_for(designation):
    """Thin airfoil theory: lift 0.3 where none flows round the nose; reflexed, no moment (Report 537)."""
    angle = (np.arange(4000) + 0.5) * np.pi / 4000
    points = naca_points(designation, 2001)
    middle = 0.5 * (points[:2001][::-1] + points[2000:])
    slope = np.interp(0.5 - 0.5 * np.cos(angle), middle[:, 0], np.gradient(middle[:, 1], middle[:, 0]))
    first, second = (2 * np.mean(slope * np.cos(n * angle)) for n in (1, 2))
    assert np.pi * first == pytest.approx(0.3, abs=0.009)
    moment = np.pi / 4 * (second - first)
    assert abs(moment) < 0.0015 if designation[2] == "1" else moment < -0.003


def test_a_sharp_section_closes_without_a_step():
    np.testing.assert_allclose(thickness(1.0 - np.array([1e-6, 0.0]), 0.12, sharp=True), 0.0, atol=1e-6)


def test_base_is_open_unless_sharp_is_asked_for():
    assert naca("0012").gap == pytest.approx(0.00252)
    assert naca("0012").blunt
    assert naca("0012-sharp").gap == 0
    assert naca("NACA 0012").name == "NACA 0012"


@pytest.mark.parametrize("designation", ["4412", "23012", "25112"])
def test_mean_lines_are_smooth_where_their_parts_meet(designation):
    points = naca_points(designation, 2001)
    middle = 0.5 * (points[:2001][::-1] + points[2000:])
    slope = np.diff(middle[:, 1]) / np.diff(middle[:, 0])
    assert np.abs(np.diff(slope)).max() < 3e-3


@pytest.mark.parametrize(
    ("designation", "message"),
    [
        ("24", "'24' is no NACA designation; use four digits"),
        ("64-212", "is no NACA designation"),
        ("2400", "NACA 2400 has no thickness"),
        ("2012", "NACA 2012 has its camber at the leading edge"),
        ("29012", "no tabulated mean line"),
        ("21112", "no tabulated mean line"),
    ],
)
def test_designations_that_stand_for_nothing_are_refused(designation, message):
    with pytest.raises(InputError, match=message):
        naca(designation)


def test_five_digits_without_lift_are_refused_and_very_thick_sections_are_noted():
    with pytest.raises(InputError, match="NACA 03012 has no design lift; use 1 to 9"):
        naca("03012")
    assert naca("24065").notes == ("NACA 24065 is 65 % thick, as its last two digits say",)
    assert naca("24024").notes == naca("0040").notes == ()
