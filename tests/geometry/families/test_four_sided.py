"""Random four-sided domains: simple, usable, and the same shape at any node counts."""

import numpy as np
import pytest

from meshonet.geometry.families.four_sided import LEAST, MOST, boundary
from meshonet.geometry.polygon.self_intersection import find_crossing

SEEDS = range(20)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_outline_is_simple_and_runs_counterclockwise(seed: int) -> None:
    outline = boundary(np.random.default_rng(seed), 65, 65).outline()
    x, y = outline.T
    assert find_crossing(outline) is None
    assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0


@pytest.mark.parametrize("seed", SEEDS)
def test_the_sides_share_their_corners_which_open_by_usable_angles(seed: int) -> None:
    edges = boundary(np.random.default_rng(seed), 65, 65)
    south, north, west, east = edges.south, edges.north, edges.west, edges.east
    for one, other in (
        (south[0], west[0]),
        (south[-1], east[0]),
        (north[0], west[-1]),
        (north[-1], east[-1]),
    ):
        np.testing.assert_array_equal(one, other)
    for at, first, second in (
        (south[0], south[1], west[1]),
        (east[0], east[1], south[-2]),
        (north[-1], north[-2], east[-2]),
        (west[-1], west[-2], north[1]),
    ):
        u, v = (complex(*(point - at)) for point in (first, second))
        assert LEAST < np.angle(v / u) < MOST


@pytest.mark.parametrize("seed", SEEDS)
def test_a_seed_is_one_shape_whose_coarse_nodes_are_nodes_of_the_fine_one(seed: int) -> None:
    coarse, fine = (boundary(np.random.default_rng(seed), n, 2 * n - 1) for n in (33, 65))
    for side in ("south", "north", "west", "east"):
        np.testing.assert_array_equal(getattr(fine, side)[::2], getattr(coarse, side))


def test_seeds_differ() -> None:
    first, second = (boundary(np.random.default_rng(seed), 17, 17).outline() for seed in (0, 1))
    assert np.abs(first - second).max() > 0.01
