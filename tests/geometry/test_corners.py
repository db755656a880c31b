import numpy as np
import pytest
from sections import STATIONS, oblique, selig

from meshonet.geometry.polygon.corners import find_corners, growth_exponent, turning


def ring(n: int) -> np.ndarray:
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.stack([np.cos(t), np.sin(t)], axis=1)


def test_turning_of_a_closed_polygon_adds_up_to_one_round():
    assert turning(ring(17), closed=True).sum() == pytest.approx(2 * np.pi)
    assert turning(ring(17)[::-1], closed=True).sum() == pytest.approx(-2 * np.pi)


def test_every_vertex_of_a_few_sided_polygon_is_a_corner():
    assert find_corners(ring(6), closed=True).tolist() == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize("n", [13, 24, 100])
def test_a_circle_has_no_corners(n):
    assert find_corners(ring(n), closed=True).size == 0


def test_a_small_kink_in_a_smooth_line_is_a_corner():
    x = np.linspace(0, 2, 41)
    line = np.stack([x, np.where(x > 1, 0.2 * (x - 1), 0.0)], axis=1)
    assert find_corners(line).tolist() == [20]


@pytest.mark.parametrize("line", [[[0, 0], [4, 0], [8.7, -1], [12, -1]], [[0, 0], [4, 0], [8, 1], [11, 3]]])
def test_two_bends_between_straight_pieces_are_corners(line):
    assert find_corners(np.array(line)).tolist() == [1, 2]


@pytest.mark.parametrize("ratio", [0.04, 0.09])
def test_a_coarse_round_nose_is_no_corner_and_the_trailing_edge_is_one(ratio):
    points = selig(ratio, x=STATIONS)
    nose = len(STATIONS) - 1
    assert abs(np.degrees(turning(points)[nose])) > 60
    assert nose not in find_corners(points[:-1], closed=True)
    assert 0 in find_corners(points[:-1], closed=True)


def test_thickness_grows_like_the_root_behind_a_nose_and_in_proportion_behind_a_wedge():
    points = selig(0.06, x=STATIONS)[:-1]
    assert growth_exponent(points, len(STATIONS) - 1) == pytest.approx(0.45, abs=0.1)
    assert growth_exponent(points, 0) == pytest.approx(1.0, abs=0.15)
    assert growth_exponent(points[:4], 0) == np.inf


@pytest.mark.parametrize("ratio", [0.03, 0.06, 0.12])
@pytest.mark.parametrize("start", [0, 1, 60])
def test_both_ends_of_an_oblique_base_are_corners(ratio, start):
    points = oblique(ratio)
    n = len(points)
    corners = (find_corners(np.roll(points, -start, axis=0), closed=True) + start) % n
    assert sorted(corners.tolist()) == [0, n - 1]


@pytest.mark.parametrize("offset", [0.02, 0.14, 0.3])
def test_points_to_both_sides_of_the_tip_of_a_round_end_are_no_base(offset):
    y = np.arange(-9, 10) + offset
    end = np.stack([y**2, 0.35 * y], axis=1)
    body = np.concatenate([end, [[200.0, 0.0]]])
    assert find_corners(body, closed=True).tolist() == []
