"""How many threads kernels work with on one grid. Results are the same to the bit for any number.

The number is one of the whole process, as that of a BLAS is; `limited_to` sets it for a while.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from meshonet.geometry.errors import InputError

MOST = 64
"""Threads that a kernel starts at the most (``TEAM_MOST`` of ``team.h``)."""

NODES_EACH = 1 << 17
"""Nodes that are worth a thread: starting it costs what the quickest kernel takes for 5,000."""
MANY_VISITS = 16
"""How often kernels that iterate, as descents and marches do, visit a node at the least."""

_limit: int | None = None


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def thread_count() -> int:
    """Return the number of threads to work with: as many as there are cores, unless limited."""
    return min(cores() if _limit is None else _limit, MOST)


def threads_for(nodes: int, visits: int = 1) -> int:
    """Return the number of threads to work with on so many nodes, each visited so often: one for few."""
    return max(min(thread_count(), visits * nodes // NODES_EACH), 1)


@contextmanager
def limited_to(threads: int | None) -> Iterator[None]:
    """Have kernels work with so many threads inside; None leaves the number as it is.

    Raises InputError: fewer than one.
    """
    global _limit
    if threads is not None and threads < 1:
        raise InputError(f"{threads} threads", "use 1 or more", parameter="threads")
    before = _limit
    _limit = before if threads is None else threads
    try:
        yield
    finally:
        _limit = before
