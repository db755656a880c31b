"""Cycles of iterations: shown on the terminal, and written to the file of ``--history``."""

import contextlib
import csv
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import astuple, fields
from pathlib import Path

from meshonet.formats.output import check_place, whole_file
from meshonet.geometry.errors import InputError
from meshonet.solvers.progress import Cycle, HistoryRow, listening
from meshonet_cli.report.grid import Report
from meshonet_cli.terminal.session import Session

COLUMNS = ("input", *(each.name for each in fields(HistoryRow)))  # of the file
INTERVAL = 0.1  # least seconds between two texts on the terminal


class Live:
    """Listener that shows solver cycles by the function `show`, at most ten per second."""

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


@contextlib.contextmanager
def followed(session: Session, history: str | None) -> Iterator[Callable[[Report, str], None]]:
    """Return a context that shows solver cycles on a terminal and writes them to the CSV file `history`.

    The context gives a function that must be called with the report and the output file of each grid. Raises
    InputError if `history` does not end in ``.csv``, or if its folder does not exist.
    """
    if history is not None:
        if Path(history).suffix.lower() != ".csv":
            raise InputError(f"{history!r} is no CSV file", "name it FILE.csv", source="--history")
        check_place(Path(history), history)
    cycles: list[tuple[str, Iterable[HistoryRow]]] = []

    def written(report: Report, path: str) -> None:
        cycles.append((report.item.label, report.history))
        session.written(report, path)

    with listening(Live(session.status)) if session.live else contextlib.nullcontext():
        yield written
    if history is not None and cycles:
        with whole_file(history) as file:
            _write(file, cycles)


def _write(path: Path, members: Iterable[tuple[str, Iterable[HistoryRow]]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(COLUMNS)
        for label, rows in members:
            table.writerows([label, *("" if x is None else x for x in astuple(row))] for row in rows)
