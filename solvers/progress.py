"""Reports the cycles of iterations to listeners; without listeners this costs no time."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.stages import added

if TYPE_CHECKING:
    from meshonet.solvers.solution import Solution


@dataclass(frozen=True)
class Cycle:
    """State of the finest grid after a cycle."""

    method: str  # that iterates
    ni: int  # nodes of the grid
    nj: int
    number: int  # of the cycle, 0 for the start; it begins anew with every attempt
    # relative to that of the transfinite interpolation; of a minimisation the norm of the gradient, relative
    # to that of its start on this grid
    residual: float
    # root mean square of what the cycle's coarse levels moved the nodes by, in units of length
    change: float | None
    folded: int  # cells
    functional: float | None = None  # value of what is minimised


Listener = Callable[[Cycle], None]
_listeners: ContextVar[tuple[Listener, ...]] = ContextVar("cycles", default=())


def listening(listener: Listener) -> AbstractContextManager[None]:
    """Return a context in which `listener` is called after every cycle, in the thread of the cycle."""
    return added(_listeners, listener)


def listened_to() -> bool:
    """Return whether there are listeners."""
    return bool(_listeners.get())


def cycle_ended(
    method: str, nodes: Floats, number: int, residual: float, change: float | None = None,
    functional: float | None = None,
) -> None:  # fmt: skip
    """Call the listeners after a cycle of `method` with the resulting `nodes` (ni, nj, 2)."""
    if not listened_to():
        return
    counts = nodes.shape[0], nodes.shape[1]
    cycle = Cycle(method, *counts, number, residual, change, count_folded(nodes), functional)
    for listener in _listeners.get():
        listener(cycle)


@dataclass(frozen=True)
class HistoryRow:
    """A cycle of a history."""

    method: str  # that iterated
    ni: int  # nodes of the grid
    nj: int
    attempt: int  # counted from 1; the next one begins where the one before diverged
    cycle: int | None  # its number, None for the result of a method without cycles
    residual: float | None  # as of `Cycle`; None where a method has none
    change: float | None
    seconds: float  # since the solve began
    folded: int | None
    functional: float | None = None


class History:
    """A listener that records the cycles of one solution."""

    def __init__(self) -> None:
        self._rows: list[HistoryRow] = []
        self._begun = time.perf_counter()
        self._attempt = 0

    def __call__(self, cycle: Cycle) -> None:
        """Record a cycle."""
        last = self._rows[-1] if self._rows else None
        if last is None or (last.ni, last.nj) != (cycle.ni, cycle.nj):
            self._attempt = 0
        self._attempt += cycle.number == 0
        place = cycle.method, cycle.ni, cycle.nj, self._attempt, cycle.number
        self._rows.append(
            HistoryRow(*place, cycle.residual, cycle.change, self._spent(), cycle.folded, cycle.functional)
        )

    def of(self, solution: Solution) -> tuple[HistoryRow, ...]:
        """Return the rows of the method of `solution`; one, with its result, for a method without cycles."""
        rows = tuple(row for row in self._rows if row.method == solution.method)
        if rows:
            return rows
        method, grid = solution.method, solution.grid
        result = solution.cycles, solution.residual, None, self._spent(), None
        return (HistoryRow(method, grid.ni, grid.nj, 1, *result),)

    def _spent(self) -> float:
        return round(time.perf_counter() - self._begun, 6)
