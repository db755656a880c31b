"""Options that say where the members of a batch are worked on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from meshonet_cli.batch.executors.engine import Engine, EngineName
from meshonet_cli.options.groups import IO, option_of

_option = option_of(IO)


# fmt: off
@dataclass(frozen=True)
class EngineOptions:
    """Where members of a batch are worked on."""

    jobs: Annotated[int, _option(
        "--jobs", metavar="N", min=1, max=1024, show_default=True, help="Processes for a batch.",
    )] = 1
    engine: Annotated[EngineName, _option(
        "--engine", metavar="processes|dask|mpi", show_default=True,
        help="What works on a batch: --jobs processes, a Dask cluster, or the ranks of MPI (mpiexec -n N "
        "meshonet ...).",
    )] = "processes"
    scheduler: Annotated[str | None, _option(
        "--scheduler", metavar="ADDRESS",
        help="Scheduler of the Dask cluster, e.g. tcp://head:8786. [default: a cluster of --jobs processes "
        "here]",
    )] = None

    def chosen(self) -> Engine:
        """Return the engine. Raises InputError: options that do not go together."""
        return Engine(self.engine, self.jobs, self.scheduler)
# fmt: on
