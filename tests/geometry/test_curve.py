import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sections import STATIONS, selig

from meshonet.geometry.blocks.resample import resample_edge
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.family import family


def circle(n: int, turns: float = 1.0) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi * turns, n, endpoint=turns < 1)
    return np.stack([np.cos(t), np.sin(t)], axis=1)


def star(seed: int, n: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return circle(n) * rng.uniform(0.3, 1.5, n)[:, None]


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(3, 40), closed=st.booleans())
def test_goes_through_its_points_bitwise(seed, n, closed):
    points = star(seed, n)
    curve = Curve(points, closed=closed)
    np.testing.assert_array_equal(curve.at(curve.knots), points)
    assert curve.knots[0] == 0
    assert (np.diff(curve.knots) > 0).all()
    np.testing.assert_array_equal(curve.at(np.array([curve.length]))[0], points[0 if closed else -1])


@pytest.mark.parametrize("closed", [True, False])
def test_places_in_any_order_next_to_points_and_beyond_the_ends(closed):
    curve = Curve(star(7, 12), closed=closed)
    s = np.random.default_rng(7).permutation(
        [
            f(k)
            for k in curve.knots[1:]
            for f in (lambda k: np.nextafter(k, 0), float, lambda k: k * (1 + 1e-15))
        ]
    )
    expected = curve.points[1:][np.abs(s[:, None] - curve.knots[1:]).argmin(axis=1)]
    np.testing.assert_allclose(curve.at(s), expected, rtol=0, atol=1e-12)
    inside = np.linspace(0.1, 0.9, 20) * curve.length
    beyond = [inside + curve.length, inside - curve.length] if closed else [inside, inside]
    for shifted in beyond:
        np.testing.assert_allclose(curve.at(shifted), curve.at(inside), rtol=0, atol=1e-12)
    ends = curve.at(np.array([-1.0, curve.length + 1.0, np.inf]) if not closed else np.zeros(3))
    np.testing.assert_array_equal(ends, curve.points[[0, 0, 0] if closed else [0, -1, -1]])


def test_parameter_is_arc_length():
    curve = Curve(selig(0.12, 0.03)[:-1], closed=True, corners=[0])
    s = np.linspace(0, curve.length, 200_001)
    steps = np.hypot(*np.diff(curve.at(s), axis=0).T)
    assert np.abs(np.cumsum(steps) - s[1:]).max() < 2e-6


@pytest.mark.parametrize("closed", [True, False])
def test_length_and_place_converge_at_fourth_order(closed):
    errors = []
    for n in (16, 32, 64):
        points = circle(n) if closed else circle(n + 1, 0.5)
        curve = Curve(points, closed=closed, corners=[])
        middle = curve.at(np.linspace(0.2, 0.8, 400) * curve.length)
        errors.append(np.abs(np.hypot(*middle.T) - 1).max())
    order = np.log2(errors[0] / errors[2]) / 2
    assert order > 3.7


def curvature(curve, s):
    """By the turn of the tangent over a short way."""
    (ax, ay), (bx, by) = curve.tangent(s - 1e-5).T, curve.tangent(s + 1e-5).T
    return (ax * by - ay * bx) / 2e-5


def test_tangent_and_curvature_of_a_circle():
    curve = Curve(2 * circle(64), closed=True)
    s = np.linspace(0, curve.length, 301)
    p, t = curve.at(s), curve.tangent(s)
    np.testing.assert_allclose(np.hypot(*t.T), 1, rtol=1e-14)
    np.testing.assert_allclose((p * t).sum(axis=1), 0, atol=1e-4)
    np.testing.assert_allclose(curvature(curve, s), 0.5, rtol=2e-3)
    assert (curvature(Curve(2 * circle(64)[::-1], closed=True), s) < 0).all()


def test_corners_stay_sharp_and_sides_straight():
    square = Curve(np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]]), closed=True)
    assert square.length == pytest.approx(6, rel=1e-15)
    assert square.corners.tolist() == pytest.approx([0, 2, 3, 5])
    np.testing.assert_allclose(square.at(np.array([1.0, 2.5, 5.5])), [[1, 0], [2, 0.5], [0, 0.5]], atol=1e-15)
    np.testing.assert_allclose(
        square.tangent(np.array([2.0 - 1e-9, 2.0 + 1e-9])), [[1, 0], [0, 1]], atol=1e-6
    )


def test_a_coarse_round_nose_stays_smooth():
    points = selig(0.06, x=STATIONS)[:-1]
    curve = Curve(points, closed=True)
    nose = len(STATIONS) - 1
    assert nose not in curve.corner_index
    before, after = curve.tangent(curve.knots[nose] + np.array([-1e-9, 1e-9]))
    assert before @ after > 0.999999


def test_invents_no_bumps_beside_a_step():
    """Two points close together, a step of 0.02 between long intervals: a plain spline swings out by 0.15."""
    x = np.array([0.0, 1, 2, 2.01, 3, 4])
    y = np.array([0.0, 0, 0, 0.02, 0.02, 0.02])
    curve = Curve(np.stack([x, y], axis=1), corners=[])
    p = curve.at(np.linspace(0, curve.length, 3000))
    assert p[:, 1].min() > -0.02
    assert p[:, 1].max() < 0.04


def test_a_symmetric_curve_is_symmetric():
    points = selig(0.09, x=STATIONS)[:-1]
    curve = Curve(points, closed=True, corners=[0])
    s = np.linspace(0, curve.length, 777)
    np.testing.assert_allclose(curve.at(s), curve.at(curve.length - s) * [1, -1], atol=1e-13)


def test_straight_intervals_follow_their_chord():
    points = circle(8)
    straight = np.zeros(8, dtype=bool)
    straight[2] = True
    curve = Curve(points, closed=True, corners=[], straight=straight)
    s = np.linspace(curve.knots[2], curve.knots[3], 50)
    off = curve.at(s) - points[2]
    along = points[3] - points[2]
    np.testing.assert_allclose(off[:, 0] * along[1] - off[:, 1] * along[0], 0, atol=1e-15)


def test_an_open_curve_is_clipped_to_its_ends():
    curve = Curve(circle(9, 0.5))
    np.testing.assert_array_equal(curve.at(np.array([-1.0, 99.0])), curve.points[[0, -1]])


@pytest.mark.parametrize(
    ("points", "closed", "message"),
    [
        ([[0, 0]], False, "give at least 2"),
        ([[0, 0], [1, 1]], True, "give at least 3"),
        ([[0, 0], [1, 1], [1, 1], [2, 0]], False, r"point 1 and the next are the same, \(1, 1\)"),
        ([[0, 0], [1, np.nan], [2, 0]], False, "point 1 is not finite"),
        ([[0, 0, 0], [1, 1, 1]], False, "shape"),
    ],
)
def test_refuses_points_that_make_no_curve(points, closed, message):
    with pytest.raises(InputError, match=message):
        Curve(np.array(points, dtype=float), closed=closed)


def test_refuses_a_corner_that_does_not_exist():
    with pytest.raises(InputError, match="no corner 9"):
        Curve(circle(5), closed=True, corners=[9])


def test_resampling_keeps_the_spacing_law():
    q = np.linspace(0, 1, 31)
    nodes = np.stack([q**2, np.zeros(31)], axis=1)
    out = resample_edge(nodes, 91, closed=False)
    np.testing.assert_allclose(out[:, 0], np.linspace(0, 1, 91) ** 2, atol=2e-4)
    np.testing.assert_array_equal(out[[0, -1]], nodes[[0, -1]])


def test_resampling_keeps_corners_on_nodes():
    nodes = np.concatenate([np.linspace([0, 0], [1, 0], 11)[:-1], np.linspace([1, 0], [1, 2], 21)])
    for m in (7, 16, 100):
        out = resample_edge(nodes, m, closed=False)
        assert np.hypot(*(out - [1, 0]).T).min() == 0


def test_resampling_a_closed_edge_stays_closed_and_keeps_its_start():
    nodes = np.concatenate([circle(40), circle(40)[:1]])
    out = resample_edge(nodes, 101, closed=True)
    np.testing.assert_array_equal(out[0], nodes[0])
    np.testing.assert_array_equal(out[-1], nodes[0])
    np.testing.assert_allclose(np.hypot(*out.T), 1, atol=1e-5)


def test_resampling_to_the_same_count_changes_next_to_nothing():
    nodes = circle(30, 0.7)
    np.testing.assert_allclose(resample_edge(nodes, 30, closed=False), nodes, atol=1e-12)


def test_arrays_that_are_kept_cannot_be_written() -> None:
    curve = Curve(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]), closed=True)
    boundary = family("arch").boundary(0.2, 11, 11)
    for kept in (curve.points, curve.knots, curve.corners, curve.corner_index, boundary.corners["south"]):
        with pytest.raises(ValueError, match="read-only"):
            kept[...] = 0


def test_a_moved_curve_is_that_through_moved_points() -> None:
    t = 2.0 * np.pi * np.arange(40) / 40
    points, shift = np.stack([np.cos(t), 0.3 * np.sin(t)], axis=1), np.array([0.5, -2.0])
    curve = Curve(points, closed=True, corners=(0, 20))
    moved, fresh = curve.moved(shift), Curve(points + shift, closed=True, corners=(0, 20))
    s = np.linspace(0.0, curve.length, 333)
    np.testing.assert_array_equal(moved.points, points + shift)
    np.testing.assert_array_equal(moved.at(moved.knots), moved.points)
    np.testing.assert_allclose(moved.at(s), fresh.at(s), atol=1e-13)
    np.testing.assert_allclose(curve.at(s) + shift, moved.at(s), atol=1e-13)
