import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.along_curve import on_corners, stretch_arcs

SQUARE = Curve(np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]), closed=True)


def test_corners_become_nodes_and_fixed_nodes_stay():
    s = np.linspace(0, 1, 21)
    out = on_corners(s, np.array([0.33, 0.61]), fixed=(10,))
    assert {0.33, 0.61, 0.0, 1.0, s[10]} <= set(out)
    assert (np.diff(out) > 0).all()
    assert np.abs(out - s).max() < 0.05


def test_corners_close_together_get_nodes_of_their_own():
    out = on_corners(np.linspace(0, 1, 11), np.array([0.5, 0.501, 0.502, 0.503]))
    assert {0.5, 0.501, 0.502, 0.503} <= set(out)
    assert (np.diff(out) > 0).all()


def test_too_many_corners_are_refused():
    with pytest.raises(InputError, match="3 corners do not fit on 4 nodes; use more nodes"):
        on_corners(np.linspace(0, 1, 4), np.array([0.4, 0.5, 0.6]))


@pytest.mark.parametrize("spacing", ["uniform", "cosine", "tanh", "curvature"])
@pytest.mark.parametrize("forward", [True, False])
def test_a_stretch_runs_from_its_begin_to_its_end_either_way(spacing, forward):
    arcs = stretch_arcs(SQUARE, 0.5, 3.5, 24, spacing, forward=forward)
    assert arcs[0] == 0.5
    assert len(arcs) == 25
    np.testing.assert_allclose(SQUARE.at(arcs[-1:]), [[0, 0.5]], atol=1e-12)
    assert (np.diff(arcs) * (1 if forward else -1) > 0).all()
    assert abs(arcs[-1] - arcs[0]) == pytest.approx(3.0 if forward else 1.0)
    passed = {1.0, 2.0, 3.0} if forward else {0.0}
    assert all(
        np.abs((arcs - corner) % 4).min() < 1e-12 or np.abs((corner - arcs) % 4).min() < 1e-12
        for corner in passed
    )


def test_curvature_spacing_is_finer_where_the_curve_turns():
    t = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    ellipse = Curve(np.stack([3 * np.cos(t), np.sin(t)], axis=1), closed=True, corners=[])
    arcs = stretch_arcs(ellipse, 0.0, 0.0, 120, "curvature")
    steps = np.diff(arcs)
    assert steps[0] < 0.5 * steps[30]
    assert max((steps[1:] / steps[:-1]).max(), (steps[:-1] / steps[1:]).max()) < 1.2
