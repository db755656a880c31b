"""The number of threads that kernels use for one grid; results are bitwise the same for any number."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from meshonet.geometry.helpers import Helpers

MOST = 64  # largest number of threads of a kernel (``TEAM_MOST`` of ``team.h``)

NODES_EACH = 1 << 17
"""Smallest number of nodes per thread; starting one takes as long as a fast kernel for 5,000 nodes."""
MANY_VISITS = 16
"""Smallest number of visits of each node by kernels that iterate, such as minimisations and marches."""

Item = TypeVar("Item")
Made = TypeVar("Made")

_limit: ContextVar[int | None] = ContextVar("threads", default=None)
_helpers: ContextVar[Helpers | None] = ContextVar("helpers", default=None)


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def thread_count() -> int:
    """Return the number of threads to use: the number of cores, unless it is limited."""
    return min(_limit.get() or cores(), MOST)


def threads_for(nodes: int, visits: int = 1) -> int:
    """Return how many threads suit a loop that visits `nodes` nodes `visits` times; 1 for short loops."""
    return max(min(thread_count(), visits * nodes // NODES_EACH), 1)


def in_threads(work: Callable[[Item], Made], items: Sequence[Item]) -> list[Made]:
    """Return the results of `work` for each of `items`, computed concurrently if threads are free.

    This saves time if an item takes milliseconds, mostly in kernels or in loops of NumPy. `work` may itself
    use its share of the threads. Items are started in order, so the longest should come first.
    """
    inside = _helpers.get()
    if len(items) < 2 or not (inside or thread_count() > 1):
        return [work(item) for item in items]
    from meshonet.geometry.helpers import Helpers  # takes longer to load than the options of a command

    share = max(thread_count() // len(items), 1)

    def shared(item: Item, helpers: Helpers) -> Made:
        _limit.set(share)
        _helpers.set(helpers)
        return work(item)

    def jobs(helpers: Helpers) -> list[Callable[[], Made]]:
        return [partial(copy_context().run, shared, item, helpers) for item in items]

    if inside:
        return inside.run(jobs(inside))
    with Helpers.at_hand(thread_count() - 1) as helpers:
        return helpers.run(jobs(helpers))


def over_blocks(work: Callable[[Item], Made], items: Sequence[Item], nodes: Sequence[int]) -> list[Made]:
    """Return the results of `work` for each of `items`; `nodes` are the node counts of the items.

    Items with many nodes are processed one by one, each with all threads; other items concurrently.
    """
    many = [threads_for(count) > 1 for count in nodes]
    few = [item for item, alone in zip(items, many, strict=True) if not alone]
    together = threads_for(sum(count for count, alone in zip(nodes, many, strict=True) if not alone)) > 1
    made = iter(in_threads(work, few) if together else map(work, few))
    return [work(item) if alone else next(made) for item, alone in zip(items, many, strict=True)]


def run_in_threads(jobs: Sequence[Callable[[], Any]]) -> list[Any]:
    """Return the results of `jobs`, computed concurrently if threads are free (see `in_threads`)."""
    return in_threads(lambda job: job(), jobs)


@contextmanager
def limited_to(threads: int | None) -> Iterator[None]:
    """Limit the number of threads of compiled functions within the ``with`` block; None changes nothing.

    Python threads that are started inside do not inherit the limit. Raises InputError: fewer than one.
    """
    if threads is not None and threads < 1:
        raise InputError(f"{threads} threads", "use 1 or more", parameter="threads")
    limit = _limit.set(_limit.get() if threads is None else threads)
    helpers = _helpers.set(_helpers.get() if threads is None else None)
    try:
        yield
    finally:
        _helpers.reset(helpers)
        _limit.reset(limit)
