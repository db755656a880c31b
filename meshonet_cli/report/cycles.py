"""Cycles as they run: on the terminal, and in the file of ``--history``."""

import time
from collections.abc import Callable, Iterable
from dataclasses import astuple, fields
from pathlib import Path

from meshonet.formats.output import check_place
from meshonet.geometry.errors import InputError
from meshonet.solvers.progress import Cycle, HistoryRow

COLUMNS = ("input", *(each.name for each in fields(HistoryRow)))  # of the file
INTERVAL = 0.1  # least seconds between two texts on the terminal


class Live:
    """Shows cycles on the terminal, ten a second at the most: `show` takes a line."""

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


def write(path: Path, members: Iterable[tuple[str, Iterable[HistoryRow]]]) -> None:
    """Write the cycles of all members, each under its label, to `path`."""
    import csv

    with path.open("w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream, lineterminator="\n")
        table.writerow(COLUMNS)
        for label, rows in members:
            table.writerows([label, *("" if x is None else x for x in astuple(row))] for row in rows)
