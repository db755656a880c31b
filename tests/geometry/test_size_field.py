import numpy as np
import pytest

from geometry.curves import Curve
from geometry.size_field import GROWTH, TURN, arcs_by_curvature, distances_by_curvature

T = np.linspace(0, 2 * np.pi, 241)[:-1]
ELLIPSE = Curve(np.stack([np.cos(T), -0.2 * np.sin(T)], axis=1) / 2, closed=True, corners=[0])
HALF = 0.5 * ELLIPSE.length


def arcs(cells: int, steps: tuple[float, float] = (1e-3, 1e-3), exact: tuple[bool, bool] = (False, False)):
    return arcs_by_curvature(ELLIPSE, (0.0, HALF, ELLIPSE.length), cells, chord=1.0, steps=steps, exact=exact)


def test_cells_grow_by_no_more_than_the_rate_when_there_are_enough():
    width = np.diff(arcs(300))
    ratio = width[1:] / width[:-1]
    assert max(ratio.max(), 1 / ratio.min()) < np.exp(GROWTH) * 1.01


def test_no_cell_turns_by_more_than_its_share_when_there_are_enough():
    s = arcs(400)
    angle = np.unwrap(np.arctan2(*ELLIPSE.tangent(s)[1:-1].T[::-1]))
    assert np.abs(np.diff(angle)).max() < 1.1 * TURN


def test_too_few_cells_keep_the_shape_of_the_field():
    few, many = np.diff(arcs(60)), np.diff(arcs(120))
    assert len(few) == 60
    assert few.min() > 1.5 * many.min()


@pytest.mark.parametrize("cells", [100, 201])
def test_steps_asked_for_are_met(cells):
    width = np.diff(arcs(cells, (2e-3, 5e-4), (True, True)))
    assert width[0] == pytest.approx(2e-3, rel=0.01)
    assert width[-1] == pytest.approx(2e-3, rel=0.01)
    assert width[cells // 2] == pytest.approx(5e-4, rel=0.05)


def test_the_field_is_symmetric_on_a_symmetric_curve():
    s = arcs(151)
    np.testing.assert_allclose(s + s[::-1], ELLIPSE.length, atol=1e-12)


def test_distances_follow_curvature_both_ways():
    forth = distances_by_curvature(ELLIPSE, 0.0, HALF, 80)
    back = distances_by_curvature(ELLIPSE, HALF, -HALF, 80)
    assert forth[[0, -1]] == pytest.approx([0, HALF])
    np.testing.assert_allclose(HALF - back[::-1], forth, atol=1e-9)
    width = np.diff(forth)
    assert width[0] < 0.5 * width[40]
