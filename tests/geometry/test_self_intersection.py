import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from meshonet.geometry.polygon import self_intersection as simple
from meshonet.geometry.polygon.self_intersection import find_crossing, find_crossings


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(3, 30), spread=st.floats(0, 1.5))
def test_agrees_with_shapely_on_random_rings(seed, n, spread):
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 2 * np.pi, n, endpoint=False) + rng.normal(0, spread / n, n)
    points = np.stack([np.cos(t), np.sin(t)], axis=1) * rng.uniform(1 - spread / 2, 1, n)[:, None]
    assert (find_crossing(points) is None) == shapely.LinearRing(points).is_simple


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 10**6), n=st.integers(2, 20))
def test_agrees_with_shapely_on_open_lines(seed, n):
    points = np.random.default_rng(seed).random((n, 2))
    assert (not find_crossings(points, closed=False)) == shapely.LineString(points).is_simple


def test_names_the_segments_and_the_place():
    bow = np.array([[0.0, 0], [2, 2], [2, 0], [0, 2]])
    result = find_crossing(bow)
    assert (result.first, result.second) == (0, 2)
    assert (result.x, result.y) == pytest.approx((1, 1))


def test_touching_counts():
    points = np.array([[0.0, 0], [4, 0], [4, 2], [2, 0], [0, 2]])
    result = find_crossing(points)
    assert (result.x, result.y) == pytest.approx((2, 0))


def test_running_back_along_the_neighbour_counts():
    spike = np.array([[0.0, 0], [2, 0], [2, 1], [2, 0.5], [0, 2]])
    assert find_crossing(spike) is not None


def test_collinear_overlap_is_placed_on_both_segments():
    points = np.array([[0.0, 0], [3, 0], [3, 1], [2, 1], [2, 0], [1, 0], [1, -1], [0, -1]])
    result = find_crossings(points)
    assert result
    assert all(0 <= c.x <= 3 and -1e-12 <= c.y <= 1 for c in result)


def test_the_tree_finds_the_same_crossings_when_the_sweep_gives_up(monkeypatch):
    points = np.random.default_rng(1).random((150, 2))
    swept = {(c.first, c.second) for c in find_crossings(points, limit=10**6)}
    monkeypatch.setattr(simple, "_BUDGET", 10)
    treed = {(c.first, c.second) for c in find_crossings(points, limit=10**6)}
    assert swept == treed
    assert len(swept) > 500


def test_the_limit_bounds_the_answer():
    assert len(find_crossings(np.random.default_rng(2).random((300, 2)), limit=5)) == 5
