"""How many threads kernels work with on one grid. Results are the same to the bit for any number.

`limited_to` sets the number for a while, for the Python thread that it is called in: others that work at the
same time keep theirs.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from meshonet.geometry.errors import InputError

MOST = 64
"""Threads that a kernel starts at the most (``TEAM_MOST`` of ``team.h``)."""

NODES_EACH = 1 << 17
"""Nodes that are worth a thread: starting it costs what the quickest kernel takes for 5,000."""
MANY_VISITS = 16
"""How often kernels that iterate, as descents and marches do, visit a node at the least."""

_limit: ContextVar[int | None] = ContextVar("threads", default=None)


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def thread_count() -> int:
    """Return the number of threads to use: that of the cores, unless limited."""
    return min(_limit.get() or cores(), MOST)


def threads_for(nodes: int, visits: int = 1) -> int:
    """Return the number of threads for so much work, in nodes times visits: one where it is little."""
    return max(min(thread_count(), visits * nodes // NODES_EACH), 1)


@contextmanager
def limited_to(threads: int | None) -> Iterator[None]:
    """Limit the threads of kernels inside the block; None keeps the number.

    Python threads that are started inside do not inherit it.

    Raises InputError: fewer than one.
    """
    if threads is not None and threads < 1:
        raise InputError(f"{threads} threads", "use 1 or more", parameter="threads")
    token = _limit.set(_limit.get() if threads is None else threads)
    try:
        yield
    finally:
        _limit.reset(token)
