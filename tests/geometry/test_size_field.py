import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.spacing.size_field import (
    GROWTH,
    HURRY,
    TURN,
    arcs_by_curvature,
    distances_by_curvature,
)

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


def test_with_few_cells_they_grow_faster_up_to_a_limit_and_the_nose_gets_fewer():
    few, many = np.diff(arcs(126)), np.diff(arcs(300))
    assert len(few) == 126
    assert few[0] == pytest.approx(1e-3, rel=0.1)  # the trailing edge keeps its step
    assert few[63] > 2.0 * many[150]
    ratio = few[1:] / few[:-1]
    assert np.exp(GROWTH) * 1.02 < max(ratio.max(), 1 / ratio.min()) < np.exp(HURRY * GROWTH) * 1.01


def test_unhurried_cells_keep_their_rate_and_the_nose_gets_fewer_still():
    unhurried = arcs_by_curvature(
        ELLIPSE,
        (0.0, HALF, ELLIPSE.length),
        140,
        chord=1.0,
        steps=(1e-3, 1e-3),
        exact=(False, False),
        hurried=False,
    )
    width, hurried = np.diff(unhurried), np.diff(arcs(140))
    ratio = width[1:] / width[:-1]
    assert max(ratio.max(), 1 / ratio.min()) < np.exp(GROWTH) * 1.01
    assert width[70] > 1.05 * hurried[70]


def test_a_step_asked_for_at_the_trailing_edge_is_not_left_in_a_hurry():
    width = np.diff(arcs(150, (2e-3, 1e-3), (True, False)))
    ratio = width[1:12] / width[:11]
    assert width[0] == pytest.approx(2e-3, rel=0.01)
    assert ratio[0] < 1.05
    assert ratio[0] < ratio[1] < ratio[2] < ratio[8] < 1.15


def test_a_sharp_bend_beside_the_trailing_edge_leaves_the_cells_there_as_they_are():
    x = np.linspace(0.0, 1.0, 200)
    bump = 0.002 * np.exp(-(((x - 0.99) / 0.002) ** 2))
    lower = np.stack([1 - x, -0.05 * np.sin(np.pi * x) - bump[::-1]], axis=1)
    curve = Curve(np.concatenate([lower, lower[-2:0:-1] * [1, -1]]), closed=True, corners=[0, 199])
    stations = 0.0, 0.5 * curve.length, curve.length
    width = np.diff(
        arcs_by_curvature(curve, stations, 200, chord=1.0, steps=(5e-3, 1e-3), exact=(True, False))
    )
    ratio = width[1:12] / width[:11]
    assert max(ratio.max(), 1 / ratio.min()) < 1.16


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
