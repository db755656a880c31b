"""Output files of a batch, and the engine that works on its members."""

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
    """Output of a command, formats, and what happens to existing results."""

    output: str  # a file, ``-``, or a pattern of files with ``{stem}``, ``{index}`` or ``{name}``
    # from_format, to_format: formats that names and content do not determine
    from_format: str | None = None
    to_format: str | None = None
    skip_existing: bool = False  # whether inputs with existing results are skipped
    part_size: int | None = None  # number of inputs in a part of a dataset


EngineName = Literal["processes", "dask", "mpi"]


@dataclass(frozen=True)
class Engine:
    """The processes that work on the members of a batch. Raises InputError: contradictory settings."""

    name: EngineName = "processes"  # processes of this machine, a Dask cluster, or the ranks of MPI
    jobs: int = 1  # number of processes, or of workers of a local Dask cluster
    scheduler: str | None = None  # address of an existing Dask scheduler

    def __post_init__(self) -> None:
        if self.scheduler is not None and self.name != "dask":
            raise InputError("{scheduler} without {engine} dask", "add {engine} dask, or drop {scheduler}")
        if self.jobs > 1 and (self.name == "mpi" or self.scheduler is not None):
            owner = "mpiexec -n" if self.name == "mpi" else "the cluster of {scheduler}"
            raise InputError(f"{{jobs}} is of no use: {owner} says how many workers there are", "drop {jobs}")

    @property
    def here(self) -> bool:
        """Whether this process does all work itself."""
        return self.name == "processes" and self.jobs == 1

    @property
    def elsewhere(self) -> bool:
        """Whether workers may be on other machines."""
        return self.name == "mpi" or self.scheduler is not None

    def threads(self, wanted: int | None = None) -> int | None:
        """Return threads per worker: `wanted` if given, else cores per worker, or None without workers."""
        if wanted is not None or self.here:
            return wanted
        return 1 if self.elsewhere else max(cores() // self.jobs, 1)

    def workers(self, warn: Warn) -> AbstractContextManager[Workers]:
        """Return a context with the workers; `warn` is called with messages about them.

        Raises InputError if the engine is not installed or cannot be reached.
        """
        # loaded here: concurrent.futures alone takes 10 ms
        module = import_module(f"meshonet_cli.batch.executors.{self.name}_engine")
        opened: AbstractContextManager[Workers] = module.opened(self, warn)
        return opened


HERE = Engine()  # this process
