"""Conformal wall spacing against maps of the circle that are known in closed form."""

import numpy as np
import pytest

from meshonet.geometry.conformal.spacing import conformal_knots
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError


def clockwise(z: np.ndarray) -> np.ndarray:
    return np.stack([z.real, -z.imag], axis=1)


def test_an_ellipse_gets_the_nodes_of_joukowskis_map() -> None:
    """z = R (t + m/t): equal angles of t are (a cos, b sin) of the same angle."""
    t = 2 * np.pi * np.arange(240) / 240
    curve = Curve(clockwise(np.cos(t) + 0.25j * np.sin(t)), closed=True, corners=[])
    knots = conformal_knots(curve, np.zeros(0), 61)
    angle = 2 * np.pi * np.arange(61) / 60
    np.testing.assert_allclose(curve.at(knots), clockwise(np.cos(angle) + 0.25j * np.sin(angle)), atol=2e-3)


def karman_trefftz(t: np.ndarray, wedge: float) -> np.ndarray:
    """Image of a circle through 1 at angles t from there; trailing edge angle `wedge` (radians)."""
    k, centre = 2 - wedge / np.pi, -0.1 + 0.05j
    z = centre + (1 - centre) * np.exp(1j * t)
    inner = slice(1, -1)
    ratio = (z[inner] - 1) / (z[inner] + 1)
    angle = np.unwrap(np.angle(ratio))
    angle -= 2 * np.pi * np.round((angle[len(angle) // 2] - np.pi) / (2 * np.pi))
    power = np.abs(ratio) ** k * np.exp(1j * k * angle)
    return np.concatenate([[k], k * (1 + power) / (1 - power), [k]])


def test_a_karman_trefftz_section_gets_equal_angles_of_its_circle() -> None:
    fine = karman_trefftz(np.linspace(0, 2 * np.pi, 801), np.radians(12))
    curve = Curve(clockwise(fine[:-1]), closed=True, corners=[0])
    nodes = curve.at(conformal_knots(curve, np.zeros(0), 81))
    exact = clockwise(karman_trefftz(np.linspace(0, 2 * np.pi, 81), np.radians(12)))
    cell = np.hypot(*np.diff(exact, axis=0).T)
    miss = np.hypot(*(nodes - exact).T)[1:-1]
    assert (miss / np.maximum(cell[1:], cell[:-1])).max() < 0.05


def lens(t: np.ndarray, edge: float) -> np.ndarray:
    """Image of the unit circle at angles t from 0 to 2 pi: arcs that meet at an angle `edge` at -2 and 2."""
    k = 2 - edge / np.pi
    power = np.tan(0.5 * np.minimum(t, 2 * np.pi - t)[1:-1]) ** k * np.exp(0.5j * np.pi * k)
    upper = np.concatenate([[k], k * (1 + power) / (1 - power), [k]])
    return np.where(t > np.pi, np.conj(upper), upper)


@pytest.mark.parametrize("degrees", [12, 40, 90])
def test_a_lens_with_two_edges_gets_equal_angles_of_its_circle(degrees: float) -> None:
    """The thinner it is, the steeper is its wall in the strip, up to 9.5: the iteration has to take care."""
    edge = np.radians(degrees)
    fine = lens(np.linspace(0, 2 * np.pi, 801), edge)
    curve = Curve(clockwise(fine[:-1]), closed=True, corners=[0, 400])
    nodes = curve.at(conformal_knots(curve, curve.knots[[400]], 81))
    exact = clockwise(lens(np.linspace(0, 2 * np.pi, 81), edge))
    cell = np.hypot(*np.diff(exact, axis=0).T)
    miss = np.hypot(*(nodes - exact).T)[1:-1]
    assert (miss / np.maximum(cell[1:], cell[:-1])).max() < 0.05


def test_marks_become_nodes_exactly_and_knots_rise() -> None:
    section = np.array([[1, 0], [1, -0.02], [0.5, -0.07], [0, 0], [0.5, 0.07], [1, 0.02]], dtype=float)
    curve = Curve(section, closed=True, corners=[0, 1, 5])
    marks = curve.knots[[1, 5]]
    knots = conformal_knots(curve, marks, 120)
    assert set(marks) <= set(knots)
    assert knots[0] == 0.0
    assert knots[-1] == curve.length
    assert np.all(np.diff(knots) > 0)


def test_a_wall_that_folds_over_itself_in_the_strip_is_refused() -> None:
    hook = np.array([[1, 0], [0.4, -0.5], [0, 0], [0.4, 0.9], [1.2, 0.9], [1.2, 0.8], [0.5, 0.75], [0.15, 0]])
    with pytest.raises(InputError, match="use another spacing"):
        conformal_knots(Curve(hook, closed=True, corners=range(8)), np.zeros(0), 80)
