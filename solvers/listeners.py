"""Functions that are called while something runs, for whoever wants to know. Usually there are none."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from typing import Generic, TypeVar

Event = TypeVar("Event")


class Listeners(Generic[Event]):
    """Functions of an event, of the thread that they were added in."""

    def __init__(self, name: str) -> None:
        self._all: ContextVar[tuple[Callable[[Event], None], ...]] = ContextVar(name, default=())

    def __bool__(self) -> bool:
        """Return whether there are any."""
        return bool(self._all.get())

    def __call__(self, event: Event) -> None:
        """Call them all."""
        for listener in self._all.get():
            listener(event)

    @contextlib.contextmanager
    def added(self, listener: Callable[[Event], None]) -> Iterator[None]:
        """Have `listener` among them inside the block."""
        token = self._all.set((*self._all.get(), listener))
        try:
            yield
        finally:
            self._all.reset(token)
