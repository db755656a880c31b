import numpy as np
import pytest

from meshonet.geometry.shapes.far_field import far_circle, o_boundary, straight


def test_far_circle_runs_clockwise_at_equal_angles_and_closes_bitwise():
    nodes = far_circle(np.array([1.0, 2.0]), 5.0, 9, 0.3)
    np.testing.assert_array_equal(nodes[0], nodes[-1])
    angle = np.unwrap(np.arctan2(*(nodes - [1, 2]).T[::-1]))
    np.testing.assert_allclose(np.diff(angle), -np.pi / 4)
    assert angle[0] == pytest.approx(0.3)


def test_straight_keeps_its_ends_bitwise():
    a, b = np.array([0.1, 0.7]), np.array([1.3, 0.2])
    nodes = straight(a, b, 7)
    np.testing.assert_array_equal(nodes[[0, -1]], [a, b])
    np.testing.assert_allclose(np.diff(nodes, axis=0), np.tile((b - a) / 6, (6, 1)))


def test_o_boundary_joins_wall_and_far_field():
    t = -np.linspace(0, 2 * np.pi, 41)
    wall = np.stack([2 * np.cos(t), np.sin(t)], axis=1)
    wall[-1] = wall[0]
    b = o_boundary(wall, 11, np.zeros(2), 20.0, name="body")
    assert (b.topology, b.ni, b.nj, b.name) == ("o", 41, 11, "body")
    np.testing.assert_array_equal(b.south, wall)
    np.testing.assert_allclose(np.hypot(*b.north.T), 20, rtol=1e-12)
    np.testing.assert_array_equal(b.west, b.east)
    assert [patch.name for patch in b.patches] == ["wall", "farfield"]
