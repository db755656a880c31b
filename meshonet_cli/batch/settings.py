"""Where the results of a batch go, and what works on its members."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Literal

from meshonet.geometry.errors import InputError
from meshonet.geometry.threads import cores

if TYPE_CHECKING:
    from meshonet_cli.batch.executors.workers import Warn, Workers


@dataclass(frozen=True)
class Files:
    """Where results go, the formats of both sides, and what becomes of results that are there.

    Parameters
    ----------
    output : a file, a pattern of files with ``{stem}``, ``{index}`` or ``{name}``, or ``-``.
    from_format, to_format : formats, where names and content do not say.
    skip_existing : whether inputs are passed over whose results are there.
    part_size : inputs in a part of a dataset.
    """

    output: str
    from_format: str | None = None
    to_format: str | None = None
    skip_existing: bool = False
    part_size: int | None = None


EngineName = Literal["processes", "dask", "mpi"]


@dataclass(frozen=True)
class Engine:
    """Where members of a batch are worked on.

    Parameters
    ----------
    name : processes of this machine, a Dask cluster, or the ranks of MPI.
    jobs : processes, or workers of a Dask cluster on this machine.
    scheduler : address of the scheduler of a Dask cluster that is there already.

    Raises InputError: they do not go together.
    """

    name: EngineName = "processes"
    jobs: int = 1
    scheduler: str | None = None

    def __post_init__(self) -> None:
        if self.scheduler is not None and self.name != "dask":
            raise InputError("{scheduler} without {engine} dask", "add {engine} dask, or drop {scheduler}")
        if self.jobs > 1 and (self.name == "mpi" or self.scheduler is not None):
            owner = "mpiexec -n" if self.name == "mpi" else "the cluster of {scheduler}"
            raise InputError(f"{{jobs}} is of no use: {owner} says how many workers there are", "drop {jobs}")

    @property
    def here(self) -> bool:
        """Whether this process does all the work."""
        return self.name == "processes" and self.jobs == 1

    @property
    def elsewhere(self) -> bool:
        """Whether workers may be on other machines."""
        return self.name == "mpi" or self.scheduler is not None

    def threads(self, wanted: int | None = None) -> int | None:
        """Return the threads of each worker: `wanted`, else its share of the cores; None: no limit."""
        if wanted is not None or self.here:
            return wanted
        return 1 if self.elsewhere else max(cores() // self.jobs, 1)

    def workers(self, warn: Warn) -> AbstractContextManager[Workers]:
        """Return the workers, to be used in a ``with`` block; `warn` says what the user must know of them.

        Raises InputError: the engine is not installed; it cannot be reached.
        """
        # loaded here: concurrent.futures alone takes 10 ms
        module = import_module(f"meshonet_cli.batch.executors.{self.name}_engine")
        opened: AbstractContextManager[Workers] = module.opened(self, warn)
        return opened


HERE = Engine()
"""This process."""
