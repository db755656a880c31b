"""Reports the stages of a long computation, and their steps, to watchers.

Without watchers this costs no time.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from meshonet.geometry.arrays import Floats

Event = TypeVar("Event")


class Listeners(Generic[Event]):
    """Functions that are called with an event, separate for each thread."""

    def __init__(self, name: str) -> None:
        self._all: ContextVar[tuple[Callable[[Event], None], ...]] = ContextVar(name, default=())

    def __bool__(self) -> bool:
        """Return whether there are any."""
        return bool(self._all.get())

    def __call__(self, event: Event) -> None:
        """Call all of them."""
        for listener in self._all.get():
            listener(event)

    @contextlib.contextmanager
    def added(self, listener: Callable[[Event], None]) -> Iterator[None]:
        """Return a context in which `listener` is one of them."""
        token = self._all.set((*self._all.get(), listener))
        try:
            yield
        finally:
            self._all.reset(token)


@dataclass(frozen=True)
class Stage:
    """A stage that has started or advanced by a step."""

    name: str  # as in the seconds by stage of results
    unit: str = ""  # what its steps are, such as level
    count: int = 0  # steps in all, 0 where nobody knows
    done: Callable[[], int] = lambda: 0  # steps so far; another thread may call it


Timings = dict[str, float]
"""Seconds by stage."""
Watcher = Callable[[Stage], None]
_watchers: Listeners[Stage] = Listeners("stages")


def watching(watcher: Watcher) -> contextlib.AbstractContextManager[None]:
    """Return a context in which `watcher` is called at the start of every stage, in its thread."""
    return _watchers.added(watcher)


def reached(name: str, unit: str = "", done: int = 0, count: int = 0) -> None:
    """Call the watchers: the stage `name` starts, or has completed `done` of `count` steps."""
    _watchers(Stage(name, unit, count, lambda: done))


@contextlib.contextmanager
def stage(name: str, seconds: Timings) -> Iterator[None]:
    """Return a context for the stage `name`: watchers are called, and its time is added to `seconds`."""
    reached(name)
    begun = time.perf_counter()
    try:
        yield
    finally:
        seconds[name] = seconds.get(name, 0.0) + time.perf_counter() - begun


@contextlib.contextmanager
def filling(name: str, unit: str, marks: Floats) -> Iterator[None]:
    """Return a context in which a kernel overwrites `marks` (steps,) one by one; watchers are called.

    Until then the marks are NaN. After the context `done` does not read them any more.
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
