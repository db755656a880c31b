"""Work in several processes."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from types import TracebackType
from typing import Literal


class Processes(ProcessPoolExecutor):
    """A pool of fresh processes that leaves interrupts to the main one and drops waiting work when it fails.

    `jobs`: how many.
    """

    def __init__(self, jobs: int) -> None:
        # one thread of numpy's linear algebra each, or the processes get in each other's way
        for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
            os.environ.setdefault(name, "1")
        # fresh processes: a fork would copy the locks of numpy's threads in whatever state they are
        super().__init__(jobs, mp_context=get_context("spawn"), initializer=_leave_interrupts)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> Literal[False]:
        """Wait for work under way; what has not begun is dropped when the block was left by an error."""
        self.shutdown(wait=True, cancel_futures=error is not None)
        return False


def _leave_interrupts() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
