"""Processes of this machine as workers."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.process import BaseProcess
from typing import TYPE_CHECKING, TypeVar

from meshonet_cli.batch.executors.workers import Warn, Workers
from meshonet_cli.terminal.stopping import hide_warnings

if TYPE_CHECKING:
    from meshonet_cli.batch.settings import Engine

T = TypeVar("T")
R = TypeVar("R")
_TERMINATED = 143  # exit code of a process after SIGTERM
_GRACE = 10.0  # seconds that a process has to remove what it was writing


@contextmanager
def opened(engine: Engine, warn: Warn) -> Iterator[Workers]:
    """Return a context with new worker processes; after an error in the context they are terminated."""
    share_cores()
    others = set(active_children())
    workers = _Processes(engine.jobs, warn)
    try:
        yield workers
    except BaseException:
        workers.executor.shutdown(wait=False, cancel_futures=True)
        _end(set(active_children()) - others)
        raise
    finally:
        workers.executor.shutdown(cancel_futures=True)


def share_cores() -> None:
    """Limit NumPy's linear algebra to one thread in processes that are started later."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def _pool(count: int) -> Executor:
    # fresh processes: a fork would copy the locks of numpy's threads in whatever state they are
    return ProcessPoolExecutor(count, mp_context=get_context("spawn"), initializer=_begin)


class _Processes(Workers):
    def __init__(self, count: int, warn: Warn) -> None:
        super().__init__(_pool(count), count)
        self._warn = warn

    def submit(self, function: Callable[[T], R], task: T) -> Future[R]:
        """Submit a task to a process."""
        return self.executor.submit(_call, function, task)

    def renew(self) -> None:
        """Replace the pool after the death of a process, which ends all other processes of the pool."""
        self._warn("a worker process died; what was under way is done again")
        self.executor.shutdown(cancel_futures=True)
        self.executor = _pool(self.count)


def _begin() -> None:
    """Initialise a worker: it ignores Ctrl-C, ends with the main process, and shows no warnings."""
    hide_warnings()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    threading.Thread(target=_watch, daemon=True).start()


class _Here:
    """State of this process for signal handlers."""

    working = ending = False


def _leave(*_: object) -> None:
    """End the process; within a task by an exception, so that unfinished files are removed."""
    if not _Here.working:
        os._exit(_TERMINATED)
    if _Here.ending:  # the pool ends the others when one has ended: they are at their clean-up
        return
    _Here.ending = True
    threading.Thread(target=_force, daemon=True).start()
    raise SystemExit(_TERMINATED)


def _force() -> None:
    threading.Event().wait(_GRACE)
    os._exit(_TERMINATED)


def _watch() -> None:
    main = parent_process()
    if main is not None:
        main.join()
        os.kill(os.getpid(), signal.SIGTERM)
        _force()


def _call(function: Callable[[T], R], task: T) -> R:
    try:
        _Here.working = True
        return function(task)
    finally:
        _Here.working = False
        if _Here.ending:  # the pool would take the exception for the outcome of the task, and go on
            os._exit(_TERMINATED)


def _end(processes: set[BaseProcess]) -> None:
    """Terminate processes, and kill those that take too long."""
    for process in processes:
        process.terminate()
    for process in processes:
        process.join(_GRACE)
        process.kill()
        process.join()
