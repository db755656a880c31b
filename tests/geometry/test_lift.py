"""The conformal lift: conformal, invertible, indifferent to where the body lies."""

import numpy as np
import pytest

from meshonet.geometry.conformal.lift import follow, lift_body, mirrored
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.naca import naca_points


def ellipse(a: float, b: float, n: int) -> np.ndarray:
    t = 2 * np.pi * np.arange(n) / n
    return a * np.cos(t) + 1j * b * np.sin(t)


def naca(designation: str, n: int = 60) -> np.ndarray:
    """Wall nodes counter-clockwise from the trailing edge, first not repeated."""
    points = naca_points(designation, n)
    z = points[:, 0] + 1j * points[:, 1]
    area = np.sum((np.conj(z) * np.roll(z, -1)).imag)
    z = z if area > 0 else z[::-1]
    return z[:-1] if abs(z[0] - z[-1]) < 1e-12 else np.concatenate([[0.5 * (z[0] + z[-1])], z])


BODIES = {
    "thin": naca("0006"),
    "cambered": naca("6412"),
    "thick": naca("4424"),
    "ellipse": ellipse(1.0, 0.3, 80),
    "circle": ellipse(1.0, 1.0, 64),
}


@pytest.mark.parametrize("body", BODIES)
def test_strip_points_map_back_to_the_wall(body: str) -> None:
    wall = BODIES[body]
    lift, w, _ = lift_body(wall)
    np.testing.assert_allclose(lift.to_plane(w), wall, atol=1e-13)


@pytest.mark.parametrize("body", BODIES)
def test_the_far_field_goes_to_the_strip_and_back(body: str) -> None:
    lift, w, _ = lift_body(BODIES[body])
    circle = 15 * np.exp(2j * np.pi * np.arange(97) / 97)
    up = lift.to_strip(circle)
    assert np.all(np.diff(up.imag) > 0)
    assert up.real.min() > w.real.max() + 2.0
    np.testing.assert_allclose(lift.to_plane(up), circle, rtol=1e-11)


@pytest.mark.parametrize("body", BODIES)
def test_the_map_has_one_complex_derivative(body: str) -> None:
    lift, w, _ = lift_body(BODIES[body])
    points, h = w.real.max() + 0.3 + 1j * np.linspace(0.1, 6.0, 23), 1e-6
    along = (lift.to_plane(points + h) - lift.to_plane(points - h)) / (2 * h)
    across = (lift.to_plane(points + 1j * h) - lift.to_plane(points - 1j * h)) / (2j * h)
    np.testing.assert_allclose(along, across, rtol=1e-7)


def test_an_ellipse_becomes_a_straight_wall() -> None:
    _, w, _ = lift_body(ellipse(1.0, 0.2, 400))
    assert np.ptp(w.real) < 2e-2
    np.testing.assert_allclose(w.imag, 2 * np.pi * np.arange(400) / 400, atol=2e-2)


@pytest.mark.parametrize("body", ["cambered", "thick", "ellipse"])
def test_translation_rotation_and_scale_leave_the_strip_alone(body: str) -> None:
    wall = BODIES[body]
    _, w, corners = lift_body(wall)
    _, moved, same = lift_body((3.0 - 2.0j) + 40.0 * np.exp(0.7j) * wall)
    np.testing.assert_allclose(moved, w, atol=1e-11)
    assert corners == same


def test_a_sharp_edge_is_one_corner_and_a_blunt_edge_two() -> None:
    blunt = naca("0012")
    assert lift_body(blunt)[2] == (1, len(blunt) - 1)
    assert lift_body(naca("0012-sharp"))[2] == (0,)


def test_too_few_nodes_are_refused_with_a_remedy() -> None:
    with pytest.raises(InputError, match="7 nodes; use at least 8"):
        lift_body(ellipse(1.0, 0.5, 7))


def test_mirrored_turns_a_clockwise_walk_counter_clockwise() -> None:
    nodes = np.array([[1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 1.0]])
    z = mirrored(nodes)
    assert np.sum((np.conj(z) * np.roll(z, -1)).imag) > 0


@pytest.mark.slow
@pytest.mark.parametrize(("camber", "crosses"), [(0.0, False), (0.03, True), (-0.03, True), (0.1, False)])
def test_the_root_is_the_one_of_a_walk_in_small_steps(camber: float, crosses: bool) -> None:
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, 31)))
    half, middle = 0.02 * np.sqrt(x) * (1 - x), 4 * camber * x * (1 - x)
    wall = np.concatenate([(x + 1j * (middle + half))[::-1], (x + 1j * (middle - half))[1:-1]])
    centre, quarter, pieces = 0.501 + 0j, 0.2495 + 0j, 400  # the slit lies inside both ends
    zeta = follow(wall, centre, quarter)
    t = np.arange(pieces) / pieces
    ring = np.append(wall, wall[0])
    path = (ring[1:-1, None] * (1 - t) + ring[2:, None] * t).ravel()[: 1 - pieces]
    both = np.polynomial.polynomial.polyroots
    walked = [zeta[1]]
    for z in path[1:]:
        roots = both([1.0, -(z - centre) / quarter, 1.0])
        walked.append(roots[np.argmin(np.abs(roots - walked[-1]))])
    np.testing.assert_allclose(zeta[1:], walked[::pieces], rtol=1e-6)
    np.testing.assert_allclose(centre + quarter * (zeta + 1 / zeta), wall, atol=1e-13)
    assert (np.abs(zeta) < 1).any() == crosses
