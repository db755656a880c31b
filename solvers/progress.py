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
    """State of the finest grid after a solver cycle."""

    method: str  # name of the method
    ni: int  # nodes of the grid
    nj: int
    number: int  # index of the cycle in this attempt, 0 for the start
    residual: float  # relative to transfinite interpolation; of minimisations, gradient relative to the start
    change: float | None  # root mean square displacement of nodes by coarse levels, in units of length
    folded: int  # number of folded cells
    functional: float | None = None  # value of the minimised functional


Listener = Callable[[Cycle], None]
_listeners: ContextVar[tuple[Listener, ...]] = ContextVar("cycles", default=())


def listening(listener: Listener) -> AbstractContextManager[None]:
    """Return a context in which `listener` is called after each solver cycle, in the thread of the cycle."""
    return added(_listeners, listener)


def listened_to() -> bool:
    """Return whether there is a listener."""
    return bool(_listeners.get())


def cycle_ended(
    method: str, nodes: Floats, number: int, residual: float, change: float | None = None,
    functional: float | None = None,
) -> None:  # fmt: skip
    """Call all listeners after a cycle of `method`, which gave `nodes` (ni, nj, 2)."""
    if not listened_to():
        return
    counts = nodes.shape[0], nodes.shape[1]
    cycle = Cycle(method, *counts, number, residual, change, count_folded(nodes), functional)
    for listener in _listeners.get():
        listener(cycle)


@dataclass(frozen=True)
class HistoryRow:
    """One cycle (iteration) of a solver in the convergence history."""

    method: str  # name of the method
    ni: int  # nodes of the grid
    nj: int
    attempt: int  # from 1; a new one begins after divergence
    cycle: int | None  # index of the cycle; None for a method without cycles
    residual: float | None  # as in `Cycle`; None if the method has none
    change: float | None
    seconds: float  # since the start of the solver
    folded: int | None
    functional: float | None = None


class History:
    """Listener that records the cycles of a solution."""

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
        """Return the recorded cycles of the solution's method; without cycles, one row with the result."""
        rows = tuple(row for row in self._rows if row.method == solution.method)
        if rows:
            return rows
        method, grid = solution.method, solution.grid
        result = solution.cycles, solution.residual, None, self._spent(), None
        return (HistoryRow(method, grid.ni, grid.nj, 1, *result),)

    def _spent(self) -> float:
        return round(time.perf_counter() - self._begun, 6)
