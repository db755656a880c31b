"""A run of a command: its output on the terminal, and its exit code."""

from __future__ import annotations

import contextlib
import json
import os
import stat
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

from meshonet.formats.source import printable
from meshonet.geometry.errors import InputError, MeshonetError
from meshonet.geometry.notes import advice_in, changes_in
from meshonet_cli.terminal.errors import explained, with_options
from meshonet_cli.terminal.stopping import check
from meshonet_cli.terminal.text import bar, quoted

if TYPE_CHECKING:
    from meshonet_cli.report.timed import Timed
    from meshonet_cli.terminal.stage_line import StageLine
    from meshonet_cli.terminal.summary import BatchSummary, MemberRow

Failures: TypeAlias = list[tuple[str, str, str, bool]]
"""Inputs, members, errors, and whether to try again: rows of `meshonet.formats.hdf5.index.Failed`."""
GATE_NOT_MET = 1  # exit code if a gate has failed
SAME_ERRORS = 3  # number of inputs that are listed for the same error; further ones are counted


class Session:
    """Prints messages and keeps the largest exit code.

    Tables and JSON go to standard output, all else to standard error. A terminal also shows progress.

    Parameters
    ----------
    quiet : whether only warnings and errors are printed.
    as_json : whether results are printed as JSON.
    debug : whether tracebacks are printed for members of a batch that fail.
    """

    def __init__(self, *, quiet: bool = False, as_json: bool = False, debug: bool = False) -> None:
        self.quiet, self.as_json, self.debug = quiet, as_json, debug
        self.worst = 0
        self.batch = False
        self.summary = False
        """Whether a table of all members is the result."""
        self.judges = False
        """Whether grids are judged by gates or profiles."""
        self.dataset = ""
        """The one file that all members go into."""
        self.failures: Failures | None = None
        """Where failed members, and those that are left out, are listed for the dataset."""
        self.rows: list[MemberRow] = []
        self._stdout_is_taken = False
        self._errors: Counter[str] = Counter()
        self.members = self.done = self.failed = self.skipped = self.beyond = self.changed = 0
        self.left_out = 0
        self._advice: dict[str, None] = {}  # printed once, at the end of a batch
        self._begun = time.perf_counter()
        self.live = not quiet and sys.stderr.isatty() and os.environ.get("TERM") != "dumb"
        self._shown = False
        self._text = ""  # of what goes on
        self._line: StageLine | None = None
        self._writing = threading.RLock()  # the line is drawn by a thread

    @contextlib.contextmanager
    def member(self, label: str, source: str | None = None) -> Iterator[None]:
        """Return a context in which an error of the member `label` is reported, and the batch continues."""
        try:
            yield
        except (KeyboardInterrupt, GeneratorExit, BrokenPipeError):
            raise
        except Exception as error:
            self.fail(label, source or label, error, repeated=True)

    def fail(self, label: str, source: str, error: Exception, *, repeated: bool = False) -> None:
        """Report a failed input. With `repeated`, the same error is printed at most `SAME_ERRORS` times."""
        from meshonet_cli.terminal.summary import MemberRow

        if self._line and not self.batch:
            self._unwatch()  # or the line is drawn again below the error
        self.failed += 1
        code = error.exit_code if isinstance(error, MeshonetError) else 2
        self.worst = max(self.worst, code)
        self.rows.append(MemberRow(label))
        line = explained(error, label)
        if self.failures is not None:
            self.failures.append((source, label, line, not isinstance(error, MeshonetError)))
        if self.debug:
            import traceback

            self._write("".join(traceback.format_exception(error)).rstrip())
        same = error.problem if repeated and isinstance(error, InputError) and not self.debug else ""
        self._errors[same] += 1
        if not same or self._errors[same] <= SAME_ERRORS:
            self._write(f"error: {line}")
        if self.as_json:
            self.result({"input": source, "output": None, "error": line, "exit_code": code})

    def judge(self, row: MemberRow) -> None:
        """Report the quality limits that a grid exceeds; keep its `row` for the table of verdicts."""
        self.rows.append(row)
        problems = row.judgement.problems if row.judgement else ()
        self.beyond += bool(problems)
        for problem in problems:
            self.worst = max(self.worst, GATE_NOT_MET)
            self._write(f"gate not met: {row.label}: {with_options(problem)}")

    def warn(self, text: str) -> None:
        """Print a message, even with `quiet`."""
        self._write(f"warning: {text}")

    def written(self, report: Timed, path: str) -> None:
        """Report what was written to `path`: in full if it is the only output, else in one line."""
        report.output = None if report.left_out else path
        if report.warning:
            self.warn(report.warning)
        self.done += not report.left_out
        self.left_out += report.left_out
        if report.left_out and self.failures is not None:
            self.failures.append(report.failure)
        if self._line and not self.batch:
            self._unwatch()
        if self.as_json:
            self.result(report.as_json())
        elif report.left_out:
            self._write(f"{report.item.label}: left out, as it fails")
        elif not self.quiet:
            self._write(report.line() if self.batch else report.lines())
        if report.notes:
            self.changed += bool(changes_in(report.notes))
            self._advice |= dict.fromkeys(advice_in(report.notes))
        if row := report.row():
            self.judge(row)

    def show(self, report: Timed) -> None:
        """Print a report as the result of the command on standard output, unless `quiet` is set."""
        self.done += 1
        if self.as_json or not self.quiet:
            self.conclude(report)

    def conclude(self, total: Timed | BatchSummary) -> None:
        """Print a report, or the table of a whole batch, on standard output, even with `quiet`."""
        if self.as_json:
            self.result(total.as_json())
        else:
            self.print(total.lines())

    def note(self, text: str) -> None:
        """Print a message, unless `quiet` or JSON is set."""
        if not (self.quiet or self.as_json):
            self._write(text)

    def result(self, facts: Mapping[str, Any]) -> None:
        """Print a JSON object on standard output at once."""
        self.print(json.dumps(facts))

    def print(self, text: str) -> None:
        """Print `text` on standard output."""
        with self._writing:
            if self._shown:
                self._clear()
            print(quoted(text), flush=True)  # noqa: T201

    def check_output(self, output: str) -> None:
        """Raise InputError if both the results and JSON are to go to standard output."""
        self._stdout_is_taken = output == "-"
        if self.as_json and output == "-":
            raise InputError(
                "--json and -o - both want standard output", "write the result to a file", source="-o"
            )

    def status(self, text: str) -> None:
        """Show `text` on a terminal in place of the previous status."""
        if self.live:
            self._text = text
            if self._line:
                self._line.detail = text
            self._draw()

    def watch(self) -> None:
        """Show on a terminal which stage is in progress, if a single input takes over a second."""
        leads = os.environ.get("RANK", "0") == "0"  # of several processes under torchrun
        if self.live and leads and not (self.as_json or self.batch or self._line or _is_pipe(1)):
            from meshonet_cli.terminal.stage_line import StageLine

            self._line = StageLine(self._draw, self._clear)

    def begin(self, name: str, count: int | None = None) -> None:
        """Show that `name`, one of `count` members of a batch, begins; raise an exception after Ctrl-C."""
        check()
        self.members += 1
        if self._line and self.batch:
            self._unwatch()
        done = self.members - 1
        if count and done < count > 1:
            spent = time.perf_counter() - self._begun
            left = f", {(count - done) * spent / done:.0f} s left" if done else ""
            self.status(f"{bar(done, count)} {self.members}/{count}{left}: {name}")
        elif done:
            self.status(f"{self.members}: {name}")

    def progress(self, done: int, count: int, text: str) -> bool:
        """Show the progress of a long task on a terminal; return whether there is a terminal."""
        self.status(f"{bar(done, count)} {text}")
        return self.live

    def skip(self, name: str, path: str, remark: str = "") -> None:
        """Report an input that is skipped because its output file exists."""
        self.skipped += 1
        self.note(f"{name} -> {path}: there already{remark}")

    def finish(self) -> int:
        """Print the summary of a batch, with a table if grids were judged, and return the exit code."""
        if self._line:
            self._unwatch()
        if self._shown:
            self._clear()
        for problem, count in self._errors.items():
            if problem and count > SAME_ERRORS:
                more = count - SAME_ERRORS
                self._write(f"error: {more} more input{'s' if more > 1 else ''}: {with_options(problem)}")
        if self.rows:
            self._tabulate(self.rows)
        if self.batch and not (self.quiet or self.as_json):
            spent = time.perf_counter() - self._begun
            beyond = self.beyond - self.left_out
            gates = f" ({beyond} of them beyond a gate)" if beyond else ""
            parts = [f"{self.done} done{gates}", f"{self.left_out} left out" if self.left_out else "",
                     f"{self.skipped} there already" if self.skipped else "",
                     f"{self.failed} failed" if self.failed else ""]  # fmt: skip
            left_out = f" and not in {self.dataset}" if self.failed and self.done and self.dataset else ""
            self._write(", ".join(filter(None, parts)) + left_out + f" in {spent:.2f} s")
            if self.changed:
                changed = "1 shape was" if self.changed == 1 else f"{self.changed} shapes were"
                self._write(f"{changed} changed: see below the line of the grid")
            for advice in self._advice:
                self._write(with_options(advice))
        return self.worst

    def _tabulate(self, rows: list[MemberRow]) -> None:
        from meshonet_cli.terminal.summary import BatchSummary

        table = BatchSummary(rows, self.judges)
        if self.summary and (table.members or table.judged):
            self.conclude(table)
        elif table.judged and self.batch and not (self.quiet or self.as_json):
            (self._write if self._stdout_is_taken else self.print)(table.lines())

    def _write(self, text: str) -> None:
        with self._writing:
            if self._shown:
                self._clear()
            print(quoted(text), file=sys.stderr)  # noqa: T201

    def _draw(self) -> None:
        with self._writing:
            text = self._line.text() if self._line else self._text
            self._clear()
            width = (os.get_terminal_size(sys.stderr.fileno()).columns or 80) - 1
            sys.stderr.write(printable(text)[:width])
            sys.stderr.flush()
            self._shown = True

    def _unwatch(self) -> None:
        if self._line:
            self._line.stop()
            self._line = None

    def _clear(self) -> None:
        if self._shown:
            sys.stderr.write("\r\x1b[2K")
            sys.stderr.flush()
            self._shown = False


def _is_pipe(descriptor: int) -> bool:
    try:
        return stat.S_ISFIFO(os.fstat(descriptor).st_mode)
    except OSError:  # it is closed
        return False
