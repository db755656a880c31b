import numpy as np

from meshonet.geometry.curves.spline import LEAST_SLACK, LONGEST, SLACK, limited
from meshonet.geometry.polygon.corners import turning

NONE = np.zeros(0, dtype=np.intp)


def test_good_tangents_are_left_alone():
    t = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    points, tangent = np.stack([np.cos(t), np.sin(t)], axis=1), np.stack([-np.sin(t), np.cos(t)], axis=1)
    start, stop = limited(points, tangent, np.roll(tangent, -1, axis=0), closed=True, corners=NONE)
    np.testing.assert_array_equal(start, tangent)
    np.testing.assert_array_equal(stop, np.roll(tangent, -1, axis=0))


def test_a_tangent_outside_its_chords_is_turned_back_and_stays_one_tangent():
    points = np.array([[0.0, 0], [1, 0], [2, 0.2], [3, 0.6], [4, 1.2]])
    slope = np.array([[1.0, 0], [np.cos(1.2), np.sin(1.2)], [1, 0.3], [1, 0.5], [1, 0.6]])
    start, stop = limited(points, slope[:-1], slope[1:], closed=False, corners=NONE)
    np.testing.assert_allclose(start[1], stop[0], atol=1e-14)
    turn = turning(points)
    assert np.arctan2(start[1, 1], start[1, 0]) <= turn[1] + SLACK * np.abs(turn).max() + LEAST_SLACK + 1e-12


def test_long_slopes_are_shortened():
    points = np.array([[0.0, 0], [1, 0], [2, 0]])
    long = np.array([[9.0, 0], [9, 0]])
    start, stop = limited(points, long, long, closed=False, corners=NONE)
    assert np.hypot(*start.T).max() <= LONGEST
    assert np.hypot(*stop.T).max() <= LONGEST


def test_tangents_at_a_sharp_edge_keep_a_quarter_of_its_wedge():
    points = np.array([[0.0, 0], [-1, 0.2], [-2, 0.9], [-1, 0.21]])  # a cusp 0.6 degrees wide
    start = np.array([[-1.0, -0.3], [-1, 0.5], [1, -0.6], [1, -0.4]])
    stop = np.array([[-1.0, 0.5], [1, 0.6], [1, -0.4], [1, 0.3]])
    first, last = limited(points, start, stop, closed=True, corners=np.array([0, 2]))
    lower, upper = np.arctan2(*-first[0]), np.arctan2(*last[-1])
    chords = np.arctan2(*-points[1]), np.arctan2(*-points[3])
    assert (lower - upper) * np.sign(chords[0] - chords[1]) >= 0.25 * abs(chords[0] - chords[1]) - 1e-12
