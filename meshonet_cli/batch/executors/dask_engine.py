"""Workers of a Dask cluster: an existing one, or one of processes on this machine.

Dask repeats the tasks of a dead worker, and raises KilledWorker if workers keep dying:
https://distributed.dask.org
"""

from __future__ import annotations

import logging
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from multiprocessing.resource_tracker import ensure_running
from pathlib import Path
from traceback import walk_tb
from typing import TYPE_CHECKING, Any, TypeVar
from weakref import WeakKeyDictionary

from meshonet import __version__
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.executors.processes_engine import share_cores
from meshonet_cli.batch.executors.workers import EngineLostError, Warn, WorkerDiedError, Workers
from meshonet_cli.batch.provenance import abridged

if TYPE_CHECKING:
    from distributed import Client

    from meshonet_cli.batch.settings import Engine

_SECONDS = 10  # to wait for the scheduler's answer
T = TypeVar("T")
R = TypeVar("R")
_SETTINGS = {
    "distributed.scheduler.allowed-failures": 1,
    "distributed.scheduler.worker-saturation": 1.0,  # a task that waits is not blamed for a death
    # looking at themselves a hundred times a second costs three processes a tenth of a core
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}  # settings of a cluster on this machine that differ from the defaults


@contextmanager
def opened(engine: Engine, warn: Warn) -> Iterator[Workers]:
    """Return a context with the workers of a Dask cluster: the one named in `engine`, or a local one."""
    try:
        import distributed  # noqa: F401  (a second)
    except ImportError:
        remedy = "install it: pip install 'meshonet[dask]'"
        raise InputError("dask needs the package distributed", remedy, parameter="engine") from None
    _silence()
    with _at(engine.scheduler) if engine.scheduler is not None else _local(engine.jobs) as client:
        workers = _Dask(client, warn)
        try:
            yield workers
        finally:
            workers.leave()


def _silence() -> None:
    """Suppress the log messages of Dask; dead workers are reported in one line."""
    for name in list(logging.root.manager.loggerDict):
        if name.startswith(("distributed", "tornado")):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)


@contextmanager
def _local(count: int) -> Iterator[Client]:
    """Return a context with the client of a local cluster; each process does one task at a time."""
    import dask
    from distributed import Client, LocalCluster

    share_cores()
    os.environ.setdefault("DASK_LOGGING__DISTRIBUTED", "critical")  # for workers, as they load it
    with dask.config.set(_SETTINGS), _without_interrupts():
        cluster = LocalCluster(
            n_workers=count, threads_per_worker=1, processes=True, dashboard_address=None, memory_limit=0,
            silence_logs=logging.CRITICAL + 1,
        )  # fmt: skip
    with cluster, Client(cluster) as client:
        yield client
        with suppress(Exception):  # those that took the place of dead ones print errors when all end at once
            client.wait_for_workers(count, timeout=_SECONDS)
            client.retire_workers(close_workers=True)


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """Return a context in which new threads and processes ignore Ctrl-C, also after the context."""
    ensure_running()  # which would let interrupts through in the thread that starts the first process
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _at(address: str) -> Iterator[Client]:
    from distributed import Client

    try:
        client = Client(address, timeout=_SECONDS)
    except (OSError, ValueError, TypeError) as error:
        remedy = "start one: dask scheduler; then give its address, tcp://HOST:8786"
        raise InputError(
            f"no Dask scheduler answers at {address!r}", remedy, parameter="scheduler"
        ) from error
    try:
        yield client
    finally:
        with suppress(Exception):  # the scheduler may be gone
            client.close(timeout=1)


class _Dask(Workers):
    """Workers of a Dask cluster; their deaths are reported while waiting for results."""

    def __init__(self, client: Client, warn: Warn) -> None:
        self._client, self._warn = client, warn
        self._address = client.scheduler.address  # a client that is closed has no scheduler
        self._events: deque[dict[str, Any]] = deque()
        self._tasks: WeakKeyDictionary[Any, tuple[Any, Any]] = WeakKeyDictionary()
        self._wait()
        client.subscribe_topic("all", self._hear)
        super().__init__(client.get_executor(pure=False), len(client.nthreads()))
        self._folder, self._words = str(Path.cwd()), abridged(sys.argv)
        self._check_versions()

    def leave(self) -> None:
        """Cancel the tasks in progress and stop listening to events."""
        with suppress(Exception):  # the scheduler may be gone
            self._client.unsubscribe_topic("all")
            self.executor.shutdown(wait=False)

    def check(self) -> None:
        """Report dead workers, count new ones, and check that the scheduler responds."""
        while self._events:
            event = self._events.popleft()
            self.count = max(1, self.count + (1 if event["action"] == "add-worker" else -1))
            if event["action"] == "remove-worker" and not event.get("expected"):
                self._warn(f"worker {event['worker']} died; what it was doing is done again")
        if self._client.status in ("closed", "closing"):
            raise self.lost()

    def lost(self) -> EngineLostError:
        """Return the error for a scheduler that does not respond."""
        problem = f"the Dask scheduler at {self._address} is gone"
        remedy = "run the command again with another; {skip_existing} keeps what is done"
        return EngineLostError(problem, remedy)

    def submit(self, function: Callable[[T], R], task: T) -> Future[R]:
        """Submit a task that runs in our working directory, with our command line."""
        from distributed.client import ClosedClientError

        try:
            future = self.executor.submit(_call, function, task, self._folder, self._words)
        except ClosedClientError as error:
            raise self.lost() from error
        self._tasks[future] = function, task
        return future

    def result(self, future: Any) -> Any:
        """Return the result of a task, or raise its error."""
        from distributed import KilledWorker
        from distributed.comm import CommClosedError

        try:
            return super().result(future)
        except TypeError as error:
            if not _died_with_its_result(error):
                raise
            return self.result(self.submit(*self._tasks[future]))
        except KilledWorker as error:
            raise WorkerDiedError from error
        except CommClosedError as error:
            raise self.lost() from error

    def _hear(self, event: tuple[float, dict[str, Any]]) -> None:
        if event[1].get("action") in ("add-worker", "remove-worker"):
            self._events.append(event[1])

    def _wait(self) -> None:
        if not self._client.nthreads():
            self._warn(f"{self._address} has no workers yet; waiting for the first")
            self._client.wait_for_workers(1)

    def _check_versions(self) -> None:
        for worker, version in self._client.run(_version, on_error="return").items():
            if version != __version__:
                has = f"meshonet {version}" if isinstance(version, str) else "no meshonet"
                remedy = "install the same version on all machines"
                raise InputError(
                    f"it has {has}, and this is {__version__}", remedy, source=f"worker {worker}"
                )


def _died_with_its_result(error: TypeError) -> bool:
    """Return whether a worker died while it sent its result."""
    # the executor takes the result for an error of three parts (distributed 2026.8, cfexecutor.py)
    frames = list(walk_tb(error.__traceback__))
    return bool(frames) and frames[-1][0].f_code.co_name == "_cascade_future"


def _version() -> str:
    return __version__


_one_at_a_time = threading.Lock()


def _call(function: Callable[[T], R], task: T, folder: str, words: list[str]) -> R:
    """Run a task in `folder`; only one at a time, since a process has one working directory."""
    with _one_at_a_time:
        sys.argv = words  # which grids have in their provenance
        try:
            os.chdir(folder)
        except OSError as error:
            remedy = "give all machines the same file system, at the same place"
            raise InputError(f"a worker does not see it ({error.strerror})", remedy, source=folder) from error
        return function(task)
