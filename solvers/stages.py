"""Stages of long work, and steps of these, for whoever watches. Usually nobody does, and it costs nothing."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.listeners import Listeners


@dataclass(frozen=True)
class Stage:
    """A stage that has begun, or gone on by a step."""

    name: str  # as in the seconds by stage of results
    unit: str = ""  # what its steps are, such as level
    count: int = 0  # steps in all, 0 where nobody knows
    done: Callable[[], int] = lambda: 0  # steps so far; another thread may call it


Watcher = Callable[[Stage], None]
_watchers: Listeners[Stage] = Listeners("stages")


def watching(watcher: Watcher) -> contextlib.AbstractContextManager[None]:
    """Call `watcher` with every stage that is reached inside the block, in the thread that reaches it."""
    return _watchers.added(watcher)


def reached(name: str, unit: str = "", done: int = 0, count: int = 0) -> None:
    """Call the watchers: the stage `name` begins, or has `done` so many of `count` steps."""
    _watchers(Stage(name, unit, count, lambda: done))


@contextlib.contextmanager
def filling(name: str, unit: str, marks: Floats) -> Iterator[None]:
    """Call the watchers about a block that overwrites `marks` (steps,) one by one, as kernels do in one call.

    For watchers the marks are NaN until then; after the block `done` does not look at them any more.
    """
    if not _watchers:
        yield
        return
    marks[:] = np.nan
    _watchers(Stage(name, unit, len(marks), lambda: len(marks) - int(np.count_nonzero(np.isnan(marks)))))
    try:
        yield
    finally:
        reached(name)
