"""Which grid of a reference set goes with which."""

from collections.abc import Iterator

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.match_grids import GridMatcher

SQUARE = np.stack(np.meshgrid([0.0, 1.0], [0.0, 1.0], indexing="ij"), axis=-1)


def grids(*names: str) -> Iterator[Grid]:
    return (Grid.from_nodes(SQUARE + k, name=name) for k, name in enumerate(names))


def places(matcher: GridMatcher, *names: str) -> list[int]:
    return [int(matcher.match(name).nodes[0, 0, 0]) for name in names]


def test_the_only_grid_goes_with_each() -> None:
    assert places(GridMatcher(grids("a")), "x", "y", "a") == [0, 0, 0]


def test_names_pair_in_any_order() -> None:
    assert places(GridMatcher(grids("a", "b", "c")), "c", "a", "b") == [2, 0, 1]
    assert places(GridMatcher(grids("a", "b", "c"), "name"), "b", "a") == [1, 0]


def test_order_pairs_what_has_no_names_in_common() -> None:
    assert places(GridMatcher(grids("a", "b", "c")), "x", "b", "a") == [0, 1, 2]
    assert places(GridMatcher(grids("", "", "")), "x", "y") == [0, 1]
    assert places(GridMatcher(grids("same", "same")), "same", "same") == [0, 1]
    assert places(GridMatcher(grids("same", "same", "b")), "b") == [0]  # such names are nobody's own
    assert places(GridMatcher(grids("a", "b"), "order"), "b", "a") == [0, 1]


def test_sets_in_the_same_order_are_not_kept() -> None:
    matcher = GridMatcher(grids(*map(str, range(9))))
    for k in range(9):
        matcher.match(str(k))
        assert len(matcher._passed) <= 1


def test_who_has_no_partner_is_told_what_to_do() -> None:
    with pytest.raises(
        InputError, match="no grid to compare it with; compare with one that is called 'x', or use"
    ):
        GridMatcher(grids("a"), "name").match("x")
    matcher = GridMatcher(grids("", ""))
    places(matcher, "a", "b")
    with pytest.raises(
        InputError, match="no grid to compare it with; compare with one grid, or with as many"
    ):
        matcher.match("c")
