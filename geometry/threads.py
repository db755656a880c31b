"""The number of threads that kernels use for one grid. Results are bitwise the same for any number.

`limited_to` sets the number temporarily, for the Python thread that calls it: other threads keep theirs.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar, copy_context
from typing import Any, TypeVar

from meshonet.geometry.errors import InputError

MOST = 64
"""Threads that a kernel starts at the most (``TEAM_MOST`` of ``team.h``)."""

NODES_EACH = 1 << 17
"""Nodes per thread: starting one takes as long as the fastest kernel takes for 5,000 nodes."""
MANY_VISITS = 16
"""How often kernels that iterate, as descents and marches do, visit a node at the least."""

Item = TypeVar("Item")
Made = TypeVar("Made")

_limit: ContextVar[int | None] = ContextVar("threads", default=None)


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def thread_count() -> int:
    """Return the number of threads to use: the number of cores, unless limited."""
    return min(_limit.get() or cores(), MOST)


def threads_for(nodes: int, visits: int = 1) -> int:
    """Return the number of threads for a loop that visits `nodes` nodes `visits` times; 1 if it is short."""
    return max(min(thread_count(), visits * nodes // NODES_EACH), 1)


def in_threads(work: Callable[[Item], Made], items: Sequence[Item]) -> list[Made]:
    """Return what `work` returns for each of `items`, several at once if threads are free.

    Worth it where each takes milliseconds, most of them in kernels or NumPy's loops. Each may use its share
    of the threads in turn.
    """
    threads = min(thread_count(), len(items))
    if threads < 2:
        return [work(item) for item in items]
    from concurrent.futures import ThreadPoolExecutor  # takes longer to load than the options of a command

    share = thread_count() // threads

    def shared(item: Item) -> Made:
        with limited_to(share):
            return work(item)

    with ThreadPoolExecutor(threads) as pool:
        jobs = [pool.submit(copy_context().run, shared, item) for item in items]
        return [job.result() for job in jobs]


def run_in_threads(jobs: Sequence[Callable[[], Any]]) -> list[Any]:
    """Return what each of `jobs` returns, several at once if threads are free (see `in_threads`)."""
    return in_threads(lambda job: job(), jobs)


@contextmanager
def limited_to(threads: int | None) -> Iterator[None]:
    """Limit the number of kernel threads within the ``with`` block; None changes nothing.

    Python threads started inside do not inherit the limit.

    Raises InputError: fewer than one.
    """
    if threads is not None and threads < 1:
        raise InputError(f"{threads} threads", "use 1 or more", parameter="threads")
    token = _limit.set(_limit.get() if threads is None else threads)
    try:
        yield
    finally:
        _limit.reset(token)
