import numpy as np

from meshonet.geometry.polygon.self_intersection import find_crossing
from meshonet.geometry.shapes.airfoil.separate_surfaces import MOST, moved_apart


def cusp(digits: int) -> np.ndarray:
    """Return a ring, clockwise from its edge, whose cusp is thinner than its digits say."""
    x = np.linspace(0, 1, 41)
    half = 0.2 * np.sqrt(x) * (1 - x) ** 3
    middle = 0.2 * x * (1 - x)
    ring = np.concatenate([np.stack([x, middle - half], 1)[::-1], np.stack([x, middle + half], 1)[1:-1]])
    return np.round(ring, digits)


def test_surfaces_that_touch_come_apart_and_no_point_moves_far():
    ring = cusp(4)
    assert find_crossing(ring) is not None
    moved = moved_apart(ring, 40)
    assert find_crossing(moved) is None
    assert np.hypot(*(moved - ring).T).max() <= MOST * 1.0001
    np.testing.assert_array_equal(moved[[0, 40]], ring[[0, 40]])


def test_thick_places_stay_as_they_are():
    ring = cusp(4)
    moved = moved_apart(ring, 40)
    front = ring[:, 0] < 0.6
    np.testing.assert_allclose(moved[front], ring[front], atol=1e-15)


def test_a_symmetric_ring_stays_symmetric():
    ring = cusp(4)
    ring[:, 1] -= np.interp(
        ring[:, 0], np.linspace(0, 1, 41), 0.2 * np.linspace(0, 1, 41) * (1 - np.linspace(0, 1, 41))
    )
    moved = moved_apart(ring, 40)
    mirrored = np.roll(moved[::-1], 1, axis=0) * [1, -1]
    symmetric = np.roll(ring[::-1], 1, axis=0) * [1, -1]
    np.testing.assert_allclose(mirrored - moved, symmetric - ring, atol=2e-4)
