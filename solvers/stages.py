"""Reports the stages of a long computation and their steps to watchers, if there are any."""

import contextlib
import time
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from meshonet.geometry.arrays import Floats

Event = TypeVar("Event")


@contextlib.contextmanager
def added(
    listeners: ContextVar[tuple[Callable[[Event], None], ...]], listener: Callable[[Event], None]
) -> Iterator[None]:
    """Return a context in which `listener` is one of the `listeners`, in this thread."""
    token = listeners.set((*listeners.get(), listener))
    try:
        yield
    finally:
        listeners.reset(token)


@dataclass(frozen=True)
class Stage:
    """Progress of one stage of a computation, which watchers get when the stage starts or advances."""

    name: str  # as in `Timings`
    unit: str = ""  # name of a step, such as level
    count: int = 0  # number of steps, 0 if unknown
    done: Callable[[], int] = lambda: 0  # number of steps so far; another thread may call it


Timings = dict[str, float]  # seconds by stage
Watcher = Callable[[Stage], None]
_watchers: ContextVar[tuple[Watcher, ...]] = ContextVar("stages", default=())


def watching(watcher: Watcher) -> contextlib.AbstractContextManager[None]:
    """Return a context in which `watcher` is called at the start of each stage, in the stage's thread."""
    return added(_watchers, watcher)


def reached(name: str, unit: str = "", done: int = 0, count: int = 0) -> None:
    """Tell the watchers that the stage `name` starts, or has completed `done` of `count` steps."""
    for watcher in _watchers.get():
        watcher(Stage(name, unit, count, lambda: done))


@contextlib.contextmanager
def stage(name: str, seconds: Timings) -> Iterator[None]:
    """Return a context for the stage `name`: its start is announced, and its time is added to `seconds`."""
    reached(name)
    begun = time.perf_counter()
    try:
        yield
    finally:
        seconds[name] = seconds.get(name, 0.0) + time.perf_counter() - begun


@contextlib.contextmanager
def filling(name: str, unit: str, marks: Floats) -> Iterator[None]:
    """Return a context for the stage `name`, in which a kernel sets one value of `marks` (steps,) per step.

    The values are NaN at first. Watchers (see `watching`) can ask how many are set; `unit` names a step.
    """
    if not (watchers := _watchers.get()):
        yield
        return
    marks[:] = np.nan
    for watcher in watchers:
        watcher(Stage(name, unit, len(marks), lambda: int(np.count_nonzero(~np.isnan(marks)))))
    try:
        yield
    finally:
        reached(name)
