"""Threads on single grids of the plane: the same bits for any number, and none where grids are small."""

import threading
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from solver_shapes import bump, naca

import meshonet
from meshonet.geometry import threads
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.cached import cached_property
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import folded_cells, measure
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.summary import Quality
from meshonet.geometry.threads import in_threads, limited_to, run_in_threads, thread_count, threads_for
from meshonet.solvers.elliptic.solve import solve, solve_thomas_middlecoff
from meshonet.solvers.elliptic.steger_sorenson import solve_steger_sorenson
from meshonet.solvers.energy import variational
from meshonet.solvers.pipeline.make_grid import make_grid
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.solution import Solution

FULL = {"coarse": None}  # solve on all nodes
SOLVERS: dict[str, Callable[..., Solution]] = {
    "winslow": solve,
    "thomas-middlecoff": solve_thomas_middlecoff,
    "steger-sorenson": solve_steger_sorenson,
    "variational": variational.solve,
}
CYCLES = 3  # enough that every kernel runs on several levels


def made(shape: Shape, method: str, count: int, **options: Any) -> tuple[bytes, Quality]:
    """Return the nodes and the quality of a grid made with so many threads."""
    request = GridRequest(method=method, threads=count, percentiles=True, allow_invalid=True, **options)
    result = make_grid(shape, request)
    return np.ascontiguousarray(result.grid.nodes).tobytes(), result.quality


def solved(boundary: Boundary, method: str, count: int) -> bytes:
    """Return the nodes after the first cycles of a method on all nodes, with so many threads."""
    with limited_to(count):
        return SOLVERS[method](boundary, max_cycles=CYCLES).grid.nodes.tobytes()


@pytest.mark.parametrize("method", SOLVERS)
def test_threads_change_no_bit_of_the_cycles_between_four_sides(eager_threads: None, method: str) -> None:
    single, *several = (solved(bump(75, 38), method, count) for count in (1, 2, 3))
    assert several == [single, single]


@pytest.mark.parametrize("method", ["winslow", "thomas-middlecoff", "variational"])
@pytest.mark.parametrize("ni", [120, 97])
def test_threads_change_no_bit_of_the_cycles_around_a_body(eager_threads: None, method: str, ni: int) -> None:
    single, *several = (solved(naca(ni, 41), method, count) for count in (1, 2, 3))
    assert several == [single, single]


@pytest.mark.parametrize(("method", "options"), [("tfi", {}), ("winslow", {}), ("variational", FULL)])
def test_threads_change_no_bit_between_four_sides(
    eager_threads: None, method: str, options: Mapping[str, Any]
) -> None:
    single, *several = (made(bump(151, 74), method, count, **options) for count in (1, 2, 3))
    assert several == [single, single]


@pytest.mark.parametrize(
    ("method", "options"),
    [
        ("conformal", {}),
        ("hyperbolic", {"first_cell": 1e-3}),
        ("winslow", {"first_cell": 1e-3}),
    ],
)
@pytest.mark.parametrize("ni", [120, 97])
def test_threads_change_no_bit_around_a_body(
    eager_threads: None, method: str, options: Mapping[str, Any], ni: int
) -> None:
    single, *several = (made(naca(ni, 41), method, count, **options) for count in (1, 2, 3))
    assert several == [single, single]


@pytest.mark.parametrize("ni", [1200, 1447])
def test_threads_change_no_bit_of_a_march_whose_levels_are_eliminated_from_both_ends(
    eager_threads: None, ni: int
) -> None:
    single, *several = (made(naca(ni, 61), "hyperbolic", count, first_cell=1e-4) for count in (1, 2, 3))
    assert several == [single, single]


def test_more_threads_than_rows_do_no_harm(eager_threads: None) -> None:
    assert made(bump(17, 9), "winslow", 50, **FULL) == made(bump(17, 9), "winslow", 1, **FULL)


def test_threads_change_nothing_in_the_measures_of_a_folded_grid(eager_threads: None) -> None:
    i, j = np.meshgrid(np.arange(601.0), np.arange(450.0), indexing="ij")
    nodes = np.stack([i, j], axis=-1) + np.random.default_rng(0).uniform(-0.4, 0.4, (601, 450, 2))
    grid = Grid.from_nodes(nodes)
    results = []
    for count in (1, 2, 5):
        with limited_to(count):
            results.append((measure(grid, percentiles=True), folded_cells(grid.nodes).tolist()))
    assert results[0][1]
    assert results[1:] == results[:1] * 2


def test_small_grids_start_no_threads() -> None:
    with limited_to(8):
        assert [threads_for(n) for n in (250 * 100, 2 * threads.NODES_EACH - 1)] == [1, 1]
        assert threads_for(3 * threads.NODES_EACH) == 3
        assert threads_for(3200 * 3200) == 8


def test_limits_of_python_threads_that_overlap_do_not_touch_each_other() -> None:
    before = threads.thread_count()
    first_in, second_in, first_out = (threading.Event() for _ in range(3))

    def first() -> int:
        with limited_to(1):
            first_in.set()
            second_in.wait(10)
            count = threads.thread_count()
        first_out.set()
        return count

    def second() -> int:
        first_in.wait(10)
        with limited_to(3):
            second_in.set()
            first_out.wait(10)
            return threads.thread_count()

    with ThreadPoolExecutor(2) as pool:
        counts = [future.result() for future in (pool.submit(first), pool.submit(second))]
    assert counts == [1, 3]
    assert threads.thread_count() == before


def test_an_inner_limit_ends_with_its_block() -> None:
    with limited_to(5):
        with limited_to(2), limited_to(None):
            assert threads.thread_count() == 2
        assert threads.thread_count() == 5


def test_quality_works_with_the_threads_that_are_wanted(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = []
    monkeypatch.setattr(
        "meshonet.geometry.quality.measure.threads_for", lambda _: seen.append(threads.thread_count()) or 1
    )
    grid = Grid.from_nodes(np.stack(np.meshgrid([0.0, 1.0], [0.0, 1.0], indexing="ij"), axis=-1))
    meshonet.quality(grid, threads=5)
    assert set(seen) == {5}
    with pytest.raises(InputError, match="0 threads"):
        meshonet.quality(grid, threads=0)


@pytest.mark.parametrize(("count", "share"), [(1, 1), (2, 1), (3, 1), (4, 2)])
def test_work_in_threads_shares_them_with_the_work_inside(count: int, share: int) -> None:
    def inside(item: int) -> tuple[int, int, list[int]]:
        return item, thread_count(), in_threads(lambda other: 10 * item + other, [1, 2])

    with limited_to(count):
        assert in_threads(inside, [4, 5]) == [(4, share, [41, 42]), (5, share, [51, 52])]


def test_threads_work_out_a_property_of_several_objects_at_once() -> None:
    both = threading.Barrier(2, timeout=10.0)

    class Slow:
        @cached_property
        def value(self) -> int:
            return both.wait() // 2

    objects = [Slow(), Slow()]
    with limited_to(2):
        assert in_threads(lambda each: each.value, objects) == [0, 0]
    assert [each.value for each in objects] == [0, 0]


def test_a_thread_without_items_helps_another_with_those_inside() -> None:
    both = threading.Barrier(2, timeout=10.0)

    def wide() -> list[int]:
        return in_threads(lambda _: both.wait(), [0, 1])

    with limited_to(2):
        several, single = run_in_threads([wide, lambda: None])
    assert (sorted(several), single) == ([0, 1], None)


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_error_of_the_first_item_that_fails_is_raised(count: int) -> None:
    def fails(item: int) -> int:
        if item in (2, 3, 5):
            raise InputError(str(item))
        return item

    with limited_to(count), pytest.raises(InputError, match=r"^2$"):
        in_threads(lambda _: in_threads(fails, range(8)), [0, 1])


def test_a_limit_inside_of_threads_starts_no_others() -> None:
    def single(_: int) -> set[int]:
        with limited_to(1):
            return set(in_threads(lambda _: threading.get_ident(), range(20)))

    with limited_to(2):
        assert [len(each) for each in in_threads(single, [0, 1])] == [1, 1]
