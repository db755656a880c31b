"""The nearest of many points along walls: by brute force, the first of equally near ones."""

from collections.abc import Callable

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import nearest_points


def _walls(count: int, rng: np.random.Generator) -> Floats:
    return rng.normal(size=(count, 2)).cumsum(axis=0)


def _lattice(count: int, rng: np.random.Generator) -> Floats:
    return np.asarray(rng.integers(-4, 5, size=(count, 2)), dtype=float)


@pytest.mark.parametrize("points_of", [_walls, _lattice])
@pytest.mark.parametrize("count", [1, 7, 64, 65, 700])
def test_the_first_nearest_of_all_points_is_found(points_of: Callable[..., Floats], count: int) -> None:
    rng = np.random.default_rng(count)
    points, places = points_of(count, rng), points_of(900, rng)
    squares = ((places[:, None] - points) ** 2).sum(axis=2)
    index, square = nearest_points(places, points)
    assert np.array_equal(index, squares.argmin(axis=1))
    assert np.array_equal(square, squares.min(axis=1))


def test_equally_near_points_of_a_circle_give_the_first() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 512, endpoint=False)
    corners = np.round(np.stack([np.cos(angle), np.sin(angle)], axis=1)) * 3.0
    index, _ = nearest_points(np.array([[0.0, 0.0], [0.0, 9.0], [0.0, 0.0]]), corners)
    exact = ((corners - [0.0, 9.0]) ** 2).sum(axis=1)
    assert index.tolist() == [0, int(exact.argmin()), 0]


def test_no_points_are_refused() -> None:
    with pytest.raises(ValueError, match="no points"):
        nearest_points(np.zeros((1, 2)), np.zeros((0, 2)))
