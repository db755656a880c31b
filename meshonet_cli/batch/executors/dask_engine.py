"""The workers of a Dask cluster: one that is there already, or one of processes of this machine.

Dask does what a dead worker had again by itself; a task whose workers keep dying ends in KilledWorker.
https://distributed.dask.org
"""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from meshonet import __version__
from meshonet.geometry.errors import InputError
from meshonet_cli.batch.executors.engine import Engine
from meshonet_cli.batch.executors.processes_engine import share_cores
from meshonet_cli.batch.executors.workers import EngineLostError, Warn, WorkerDiedError, Workers

if TYPE_CHECKING:
    from distributed import Client

_SECONDS = 10  # to wait for the scheduler's answer
_LOST = "run it again, with {skip_existing}, when there is one"


@contextmanager
def opened(engine: Engine, warn: Warn) -> Iterator[Workers]:
    """Give the workers of the cluster at the engine's scheduler, or of one of its own."""
    try:
        import distributed  # noqa: F401  (a second)
    except ImportError:
        remedy = "install it: pip install 'meshonet[dask]'"
        raise InputError("dask needs the package distributed", remedy, parameter="engine") from None
    for name in ("distributed", "tornado"):  # what they say of a lost worker or scheduler is said here
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    with _at(engine.scheduler) if engine.scheduler is not None else _local(engine.jobs) as client:
        workers = _Dask(client, warn)
        try:
            yield workers
        finally:
            workers.leave()


@contextmanager
def _local(count: int) -> Iterator[Client]:
    """Give the client of a cluster of processes of this machine, which work on one task at a time each."""
    import dask
    from distributed import Client, LocalCluster

    share_cores()
    settings = {
        "distributed.scheduler.allowed-failures": 1,
        "distributed.scheduler.worker-saturation": 1.0,  # a task that waits is not blamed for a death
    }
    with (
        dask.config.set(settings),
        LocalCluster(
            n_workers=count, threads_per_worker=1, processes=True, dashboard_address=None, memory_limit=0,
            silence_logs=logging.CRITICAL + 1,
        ) as cluster,
        Client(cluster) as client,
    ):  # fmt: skip
        yield client


@contextmanager
def _at(address: str) -> Iterator[Client]:
    """Give the client of the scheduler at an address."""
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
    """Workers of a cluster; deaths are events of the scheduler, and said where results are waited for."""

    def __init__(self, client: Client, warn: Warn) -> None:
        self._client, self._warn = client, warn
        self._events: deque[dict[str, Any]] = deque()
        self._wait()
        client.subscribe_topic("all", self._hear)
        super().__init__(client.get_executor(pure=False), len(client.nthreads()))
        self._check_versions()

    def leave(self) -> None:
        """Drop what is under way and listen no more."""
        with suppress(Exception):  # the scheduler may be gone
            self._client.unsubscribe_topic("all")
            self.executor.shutdown(wait=False)

    def check(self) -> None:
        """Say which workers died, count those that came, and see that the scheduler is there."""
        while self._events:
            event = self._events.popleft()
            self.count = max(1, self.count + (1 if event["action"] == "add-worker" else -1))
            if event["action"] == "remove-worker" and not event.get("expected"):
                self._warn(f"worker {event['worker']} died; what it was doing is done again")
        if self._client.status in ("closed", "closing"):
            raise EngineLostError("the Dask scheduler is gone", _LOST)

    def result(self, future: Any) -> Any:
        """Return the result of a task, or raise what it ended in."""
        from distributed import KilledWorker
        from distributed.comm import CommClosedError

        try:
            return super().result(future)
        except KilledWorker as error:
            raise WorkerDiedError from error
        except CommClosedError as error:
            raise EngineLostError("the Dask scheduler is gone", _LOST) from error

    def _hear(self, event: tuple[float, dict[str, Any]]) -> None:
        if event[1].get("action") in ("add-worker", "remove-worker"):
            self._events.append(event[1])

    def _wait(self) -> None:
        if not self._client.nthreads():
            self._warn(f"{self._client.scheduler.address} has no workers yet; waiting for the first")
            self._client.wait_for_workers(1)

    def _check_versions(self) -> None:
        """Raise InputError where a worker cannot run this program."""
        for worker, version in self._client.run(_version, on_error="return").items():
            if version != __version__:
                has = f"meshonet {version}" if isinstance(version, str) else "no meshonet"
                remedy = "install the same version on all machines"
                raise InputError(
                    f"it has {has}, and this is {__version__}", remedy, source=f"worker {worker}"
                )


def _version() -> str:
    from meshonet import __version__

    return __version__
