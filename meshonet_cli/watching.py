"""Cycles as they run: on the terminal, and in the file of ``--history``."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from dataclasses import astuple, dataclass
from pathlib import Path

from meshonet.formats.output import check_place
from meshonet.geometry.errors import InputError
from meshonet.solvers.progress import Cycle
from meshonet.solvers.solution import Solution

COLUMNS = (
    "input",
    "method",
    "ni",
    "nj",
    "attempt",
    "cycle",
    "residual",
    "change",
    "seconds",
    "folded",
    "functional",
)
"""Of the file; see `Row`."""

INTERVAL = 0.1
"""Least seconds between two texts on the terminal."""


@dataclass(frozen=True)
class Row:
    """A cycle in the file.

    Parameters
    ----------
    method : that iterated.
    ni, nj : nodes of the grid.
    attempt : counted from 1; the next one begins where the one before diverged.
    residual, change, folded, functional : see `meshonet.solvers.progress.Cycle`; None where a method has none.
    seconds : since the solve began.
    """

    method: str
    ni: int
    nj: int
    attempt: int
    cycle: int | None
    residual: float | None
    change: float | None
    seconds: float
    folded: int | None
    functional: float | None = None


class Recorder:
    """Keeps the cycles of one solve."""

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self._begun = time.perf_counter()
        self._attempt = 0

    def __call__(self, cycle: Cycle) -> None:
        """Keep a cycle."""
        last = self.rows[-1] if self.rows else None
        if last is None or (last.ni, last.nj) != (cycle.ni, cycle.nj):
            self._attempt = 0
        self._attempt += cycle.number == 0
        spent = round(time.perf_counter() - self._begun, 6)
        place = cycle.method, cycle.ni, cycle.nj, self._attempt, cycle.number
        self.rows.append(Row(*place, cycle.residual, cycle.change, spent, cycle.folded, cycle.functional))

    def of(self, solution: Solution) -> tuple[Row, ...]:
        """Return the rows of the method that made it; of one that tells of no cycles, one for its result."""
        rows = tuple(row for row in self.rows if row.method == solution.method)
        if rows:
            return rows
        grid, spent = solution.grid, round(time.perf_counter() - self._begun, 6)
        return (
            Row(solution.method, grid.ni, grid.nj, 1, solution.cycles, solution.residual, None, spent, None),
        )


class Live:
    """Shows cycles on the terminal, ten a second at the most.

    Parameters
    ----------
    show : takes a line.
    """

    def __init__(self, show: Callable[[str], None]) -> None:
        self._show = show
        self._last = -INTERVAL

    def __call__(self, cycle: Cycle) -> None:
        """Show a cycle."""
        now = time.perf_counter()
        if now - self._last < INTERVAL:
            return
        self._last = now
        folded = f", {cycle.folded} folded" if cycle.folded else ""
        self._show(f"{cycle.ni}x{cycle.nj}: cycle {cycle.number}, residual {cycle.residual:.1e}{folded}")


def check_file(text: str | None) -> None:
    """Raise InputError when a file of cycles does not end in ``.csv`` or has no folder to be in."""
    if text is None:
        return
    if Path(text).suffix.lower() != ".csv":
        raise InputError("cycles are written as a table of commas", "name a file, F.csv", source="--history")
    check_place(Path(text), text)


def write(path: Path, members: Iterable[tuple[str, Iterable[Row]]]) -> None:
    """Write the cycles of all members, each under its label, to `path`."""
    import csv

    with path.open("w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(COLUMNS)
        for label, rows in members:
            table.writerows([label, *("" if x is None else x for x in astuple(row))] for row in rows)
