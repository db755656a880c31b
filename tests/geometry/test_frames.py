"""Frames along paths: right-handed, without turning, and closed where the path is."""

import numpy as np
import pytest

from meshonet.geometry.curves.frames import frames_along
from meshonet.geometry.curves.path import Bend, PiecedPath, SplinePath
from meshonet.geometry.errors import InputError


def helix(n: int = 201) -> SplinePath:
    t = np.linspace(0.0, 4.0 * np.pi, n)
    return SplinePath(np.stack([np.cos(t), np.sin(t), 0.5 * t], axis=1))


def knot(n: int = 201) -> SplinePath:
    t = np.linspace(0.0, 2.0 * np.pi, n)
    x, y = np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t)
    points = np.stack([x, y, -np.sin(3 * t)], axis=1)
    points[-1] = points[0]
    return SplinePath(points)


@pytest.mark.parametrize("path", [helix(), knot()], ids=["helix", "knot"])
def test_axes_and_tangent_are_right_handed_and_orthonormal(path):
    s = np.linspace(0.0, path.length, 101)
    x, y = frames_along(path, s)
    axes = np.stack([x, y, path.at(s).tangents], axis=1)
    assert np.einsum("nij,nkj->nik", axes, axes) == pytest.approx(np.tile(np.eye(3), (101, 1, 1)), abs=1e-9)
    assert np.linalg.det(axes) == pytest.approx(np.ones(101))


def test_along_a_helix_they_turn_against_the_normal_by_the_torsion():
    """The angle between the normal and a frame without turning grows by the torsion (Bishop 1975)."""
    path = helix()
    s = np.linspace(0.0, path.length, 201)
    x, y = frames_along(path, s)
    normal = path.at(s).curvature
    angle = np.unwrap(np.arctan2((normal * y).sum(axis=1), (normal * x).sum(axis=1)))
    torsion = 0.5 / (1.0 + 0.25)
    inner = slice(20, -20)  # away from the ends of the spline
    rate = np.gradient(angle, s)[inner]
    assert rate == pytest.approx(np.full(len(rate), torsion), rel=5e-3)


def test_in_a_plane_the_axis_across_it_stays():
    path = PiecedPath((Bend(1.0), Bend(2.0, 1.0, (0, 1, 0)), Bend(1.0)), np.zeros(3), np.array([1.0, 0, 0]))
    _, y = frames_along(path, np.linspace(0.0, path.length, 50))
    assert y == pytest.approx(np.tile([0.0, 0.0, 1.0], (50, 1)), abs=1e-12)


def test_along_a_closed_path_the_last_frame_is_the_first():
    path = knot()
    x, y = frames_along(path, np.linspace(0.0, path.length, 301))
    assert y[-1] == pytest.approx(y[0], abs=1e-9)
    assert x[-1] == pytest.approx(x[0], abs=1e-9)


def test_they_are_of_fourth_order_in_the_step():
    path, ends = helix(2001), []
    for n in (11, 21, 41, 641):
        ends.append(frames_along(path, np.linspace(0.0, path.length, n))[1][-1])
    errors = [np.linalg.norm(end - ends[-1]) for end in ends[:-1]]
    assert np.log2(errors[0] / errors[1]) > 3.5
    assert np.log2(errors[1] / errors[2]) > 3.5


def test_up_is_where_the_y_axis_points_and_may_not_lie_along_the_path():
    path = SplinePath(np.array([[0.0, 0, 0], [1, 0, 0]]))
    _, y = frames_along(path, np.array([0.0, 1.0]), np.array([5.0, 3.0, 4.0]))
    assert y[0] == pytest.approx([0.0, 0.6, 0.8])
    with pytest.raises(InputError, match="along the path"):
        frames_along(path, np.array([0.0, 1.0]), np.array([2.0, 0.0, 0.0]))
