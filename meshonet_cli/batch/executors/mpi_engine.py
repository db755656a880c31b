"""Ranks of MPI as workers: rank 0 of ``mpiexec -n 9 meshonet ... --engine mpi`` has eight.

The other ranks work inside `on_ranks` until it ends:
https://mpi4py.readthedocs.io/en/stable/mpi4py.futures.html
"""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from meshonet.geometry.errors import InputError
from meshonet_cli.batch.executors.workers import Warn, Workers

if TYPE_CHECKING:
    from mpi4py.futures import MPIPoolExecutor

    from meshonet_cli.batch.settings import Engine

_ranks: MPIPoolExecutor | None = None  # executor of the other ranks, while the program runs inside `on_ranks`


def on_ranks(run: Callable[[], int]) -> int:
    """Call `run` on MPI rank 0, with the other ranks as workers; return its exit code, 0 on other ranks."""
    global _ranks
    try:
        from mpi4py import MPI
        from mpi4py.futures import MPICommExecutor
    except (ImportError, RuntimeError):  # the package, or the library of MPI, is not there: `opened` says so
        return run()
    if MPI.COMM_WORLD.Get_size() == 1:
        return run()
    if MPI.COMM_WORLD.Get_rank() > 0:
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # rank 0 is interrupted too, and ends the others
    with MPICommExecutor(MPI.COMM_WORLD) as ranks:
        if ranks is None:
            return 0
        _ranks = ranks
        try:
            return run()
        finally:
            _ranks = None
            ranks.shutdown(wait=False, cancel_futures=True)


@contextmanager
def opened(engine: Engine, warn: Warn) -> Iterator[Workers]:  # noqa: ARG001  (the signature of all engines)
    """Return a context with all MPI ranks but rank 0 as workers."""
    if _ranks is None:
        _check_installed()
        remedy = "start the program as mpiexec -n 3 meshonet ..., which has two workers"
        raise InputError("there is no other rank", remedy, parameter="engine")
    yield Workers(_ranks, _ranks.num_workers)


def _check_installed() -> None:
    try:
        from mpi4py import MPI  # noqa: F401
    except (ImportError, RuntimeError) as error:
        problem = f"mpi needs the package mpi4py and a library of MPI ({str(error).splitlines()[0]})"
        remedy = "install them: pip install 'meshonet[mpi]' mpich"
        raise InputError(problem, remedy, parameter="engine") from None
