import numpy as np
import pytest

from meshonet.geometry.curves.spline import LONGEST, spline_slopes
from meshonet.geometry.polygon.corners import turning

NONE = np.zeros(0, dtype=np.intp)


def test_slopes_are_those_of_the_twice_continuous_spline():
    """Oracle: the second derivatives of the two cubics at each inner point, from their Hermite data."""
    t = np.linspace(0, 1.5, 12)
    points = np.stack([t, np.sin(2 * t)], axis=1)
    start, stop = spline_slopes(points, closed=False, corners=NONE)
    chord = np.diff(points, axis=0)
    h = np.hypot(*chord.T)[:, None]
    before = (2 * start + 4 * stop) / h - 6 * chord / h**2
    after = 6 * chord / h**2 - (4 * start + 2 * stop) / h
    np.testing.assert_allclose(before[:-1], after[1:], atol=1e-10)
    np.testing.assert_allclose(stop[:-1], start[1:], atol=1e-14)


def test_periodic_slopes_of_a_circle_are_its_tangents():
    t = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    points = np.stack([np.cos(t), np.sin(t)], axis=1)
    start, stop = spline_slopes(points, closed=True, corners=NONE)
    np.testing.assert_allclose((start * points).sum(axis=1), 0, atol=1e-12)
    np.testing.assert_allclose(stop, np.roll(start, -1, axis=0), atol=1e-12)


def test_a_single_interval_between_corners_is_straight():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [3.0, 2.0]])
    start, stop = spline_slopes(points, closed=False, corners=np.array([1, 2]))
    np.testing.assert_allclose(start, [[1, 0], [0, 1], [1, 0]])
    np.testing.assert_allclose(stop, start)


def test_tangents_stay_near_the_angle_between_their_chords():
    """Short intervals beside long ones make a plain spline swing out by more than 60 degrees here."""
    points = np.array([[0, 0], [1, 0], [1.01, 0.01], [1.02, 0.0], [2, 0], [3, 0]], dtype=float)
    start, stop = spline_slopes(points, closed=False, corners=NONE)
    turn = turning(points)
    around = np.maximum(np.abs(turn), np.maximum(np.abs(np.roll(turn, 1)), np.abs(np.roll(turn, -1))))
    chord = np.diff(points, axis=0)
    for k in range(1, 5):
        at = np.arctan2(*start[k][::-1]) - np.arctan2(*chord[k - 1][::-1])
        slack = 0.25 * around[k] + np.radians(0.6)
        assert min(turn[k], 0) - slack <= at <= max(turn[k], 0) + slack
    assert np.hypot(*start.T).max() <= LONGEST + 1e-12
    assert np.hypot(*stop.T).max() <= LONGEST + 1e-12


@pytest.mark.parametrize("lift", [0.0, 0.01])
def test_a_thin_cusp_is_kept_open(lift):
    """Coarse points at a cusp: plain parabolas at its tip would cross, and so invert the wedge."""
    upper = np.array([[0, 0], [-0.05, 0.0072], [-0.1, 0.0128], [-0.2, 0.02], [-0.5, 0.05]])
    lower = np.array([[-0.5, -0.05], [-0.2, 0.0149], [-0.1, 0.0118], [-0.05, 0.0069]])
    lower[:, 1] -= lift / 10
    ring = np.concatenate([upper, lower])[::-1]
    ring = np.roll(ring, 1, axis=0)
    start, stop = spline_slopes(ring, closed=True, corners=np.array([0]))
    out, back = start[0], -stop[-1]
    assert back[0] * out[1] - back[1] * out[0] > 0  # the lower side lies left of the upper, looking forward
