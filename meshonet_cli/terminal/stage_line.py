"""Status line for the stage of a single long input: ``12 s, grid: level 34/100, 23 s left``.

A thread draws it while the main thread runs kernels, which release the interpreter lock.
"""

import contextlib
import threading
import time
from collections.abc import Callable

from meshonet.solvers.stages import Stage, watching
from meshonet_cli.terminal.stopping import LINES
from meshonet_cli.terminal.text import bar, duration

DELAY = 1.0  # seconds without a line: most work is done by then
INTERVAL = 0.2  # seconds between two lines
HELD = 1.0  # seconds to wait for a terminal that is held, at the most


class StageLine:
    """Thread that, after one second, calls `draw` five times per second; `stop` calls `clear`."""

    def __init__(self, draw: Callable[[], None], clear: Callable[[], None]) -> None:
        self._draw, self._clear = draw, clear
        self.detail = ""  # of the stage
        self._begun = self._since = time.perf_counter()
        self._stage = Stage("read")
        self._stopped = threading.Event()
        self._watching = contextlib.ExitStack()
        self._watching.enter_context(watching(self._reached))
        self._thread = threading.Thread(target=self._run, name="stage line", daemon=True)
        self._thread.start()
        LINES.append(self)

    def stop(self) -> None:
        """Stop the thread, wait for its end, and remove the line."""
        if self in LINES:
            LINES.remove(self)
            self._stopped.set()
            self._thread.join(HELD)
            self._watching.close()
            self._clear()

    def text(self) -> str:
        """Return the text of the line: elapsed time, stage, and progress or, if unknown, a detail."""
        stage, now = self._stage, time.perf_counter()
        spent = now - self._begun
        if spent < DELAY:
            return self.detail
        head = f"{duration(spent)}, {stage.name}"
        done = stage.done()
        if not stage.count:
            detail = f"{stage.unit} {done}" if done else self.detail
            return f"{head}: {detail}" if detail else head
        left = (stage.count - done) * (now - self._since) / done if done else None
        rest = "" if left is None else f", {duration(left)} left"
        return f"{bar(done, stage.count)} {head}: {stage.unit} {done}/{stage.count}{rest}"

    def _reached(self, stage: Stage) -> None:
        if (stage.name, stage.unit, stage.count) != (self._stage.name, self._stage.unit, self._stage.count):
            self._since = time.perf_counter()
        if stage.name != self._stage.name:
            self.detail = ""
        self._stage = stage

    def _run(self) -> None:
        wait = DELAY
        with contextlib.suppress(OSError, ValueError):  # the terminal has gone
            while not self._stopped.wait(wait):
                self._draw()
                wait = INTERVAL
