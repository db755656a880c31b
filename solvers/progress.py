"""What iterations tell while they run, to whoever listens. Usually nobody does, and it costs nothing."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from dataclasses import dataclass

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded


@dataclass(frozen=True)
class Cycle:
    """State of the finest grid after a cycle.

    Parameters
    ----------
    method : that iterates.
    ni, nj : nodes of the grid.
    number : of the cycle, 0 for the start; it begins anew with every attempt.
    residual : relative to that of the transfinite interpolation; of a minimisation the norm of the gradient,
        relative to that of its start on this grid.
    change : root mean square of what the cycle's coarse levels moved the nodes by, in units of length.
    folded : cells.
    functional : value of what is minimised.
    """

    method: str
    ni: int
    nj: int
    number: int
    residual: float
    change: float | None
    folded: int
    functional: float | None = None


Listener = Callable[[Cycle], None]
_listeners: ContextVar[tuple[Listener, ...]] = ContextVar("listeners", default=())


@contextlib.contextmanager
def listening(listener: Listener) -> Iterator[None]:
    """Have `listener` called after every cycle that runs inside the block, in its thread."""
    token = _listeners.set((*_listeners.get(), listener))
    try:
        yield
    finally:
        _listeners.reset(token)


def heard() -> bool:
    """Return whether anybody listens."""
    return bool(_listeners.get())


def tell(
    method: str,
    nodes: Floats,
    number: int,
    residual: float,
    change: float | None = None,
    functional: float | None = None,
) -> None:
    """Tell the listeners of a cycle of `method` that left the grid as `nodes` (ni, nj, 2)."""
    listeners = _listeners.get()
    if not listeners:
        return
    counts = nodes.shape[0], nodes.shape[1]
    cycle = Cycle(method, *counts, number, residual, change, count_folded(nodes), functional)
    for listener in listeners:
        listener(cycle)
