"""Paths in space: splines against circles and helices, lines and arcs against their formulas."""

import numpy as np
import pytest

from meshonet.geometry.curves.path import Bend, PiecedPath, SplinePath
from meshonet.geometry.errors import InputError


def circle(n: int) -> np.ndarray:
    angle = np.linspace(0.0, 2.0 * np.pi, n + 1)
    points = np.stack([2.0 * np.cos(angle), 2.0 * np.sin(angle), 0.0 * angle], axis=1)
    points[-1] = points[0]
    return points


def helix(n: int) -> np.ndarray:
    t = np.linspace(0.0, 3.0, n)
    return np.stack([3.0 * np.cos(t), 3.0 * np.sin(t), 4.0 * t], axis=1)


def test_a_spline_through_points_of_a_circle_is_one_to_fourth_order():
    errors = [abs(SplinePath(circle(n)).length - 4.0 * np.pi) for n in (16, 32, 64)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (orders > 3.8).all()
    assert errors[-1] < 1e-5


def test_a_path_whose_last_point_is_its_first_is_closed_and_smooth_there():
    path = SplinePath(circle(64))
    assert path.closed
    start, end = path.at(np.array([0.0])), path.at(np.array([path.length]))
    assert np.array_equal(start.points, end.points)
    assert start.tangents == pytest.approx(end.tangents, abs=1e-12)
    assert start.curvature == pytest.approx(end.curvature, abs=1e-12)


def test_places_are_at_equal_arc_lengths_and_curvature_points_to_the_centre():
    path = SplinePath(circle(128))
    places = path.at(np.linspace(0.0, path.length, 333))
    steps = np.linalg.norm(np.diff(places.points, axis=0), axis=1)
    assert np.ptp(steps) < 1e-7 * steps.mean()
    assert places.curvature == pytest.approx(-places.points / 4.0, abs=2e-4)
    assert np.linalg.norm(places.tangents, axis=1) == pytest.approx(np.ones(333))


def test_an_open_spline_meets_its_points_and_keeps_away_from_its_ends_to_the_curve():
    points = helix(41)
    path = SplinePath(points)
    assert not path.closed
    assert path.length == pytest.approx(15.0, abs=2e-3)  # 5 a radian
    assert np.array_equal(path.at(np.array([0.0, path.length])).points, points[[0, -1]])
    middle = path.at(np.array([0.5 * path.length]))
    assert np.linalg.norm(middle.curvature) == pytest.approx(3.0 / 25.0, rel=1e-3)


def test_a_line_an_arc_and_a_line_follow_their_formulas():
    quarter = Bend(0.5 * np.pi * 1.5, 1.5, (0.0, 1.0, 0.0))
    path = PiecedPath((Bend(1.0), quarter, Bend(2.0)), np.zeros(3), np.array([2.0, 0.0, 0.0]))
    assert path.length == pytest.approx(3.0 + 0.75 * np.pi)
    places = path.at(np.array([0.5, 1.0 + 0.5 * quarter.length, 1.0 + quarter.length, path.length]))
    half = np.sqrt(0.5)
    expected = [[0.5, 0, 0], [1 + 1.5 * half, 1.5 * (1 - half), 0], [2.5, 1.5, 0], [2.5, 3.5, 0]]
    assert places.points == pytest.approx(np.array(expected))
    assert places.tangents[1] == pytest.approx([half, half, 0.0])
    assert np.linalg.norm(places.curvature, axis=1) == pytest.approx([0.0, 1 / 1.5, 0.0, 0.0])


@pytest.mark.parametrize(
    ("points", "problem"),
    [
        (np.zeros((1, 3)), "a path of 1 points"),
        (np.zeros((3, 2)), "shape (3, 2)"),
        (np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]]), "point 1 of the path and the next"),
        (np.array([[0.0, 0, 0], [1, np.nan, 0]]), "point 1 of the path is not finite"),
    ],
)
def test_points_that_are_no_path_are_refused(points, problem):
    with pytest.raises(InputError) as refusal:
        SplinePath(points)
    assert problem in str(refusal.value)


@pytest.mark.parametrize(
    ("pieces", "problem"),
    [
        ((), "a path without pieces"),
        ((Bend(-1.0),), "a length of -1"),
        ((Bend(1.0), Bend(1.0, 2.0, (1.0, 0.0, 0.0))), "the bend of pieces[1] has no direction"),
    ],
)
def test_pieces_that_are_no_path_are_refused(pieces, problem):
    with pytest.raises(InputError) as refusal:
        PiecedPath(pieces, np.zeros(3), np.array([1.0, 0.0, 0.0]))
    assert problem in str(refusal.value)
