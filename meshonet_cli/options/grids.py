"""The options of every command that turns boundaries into grids."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from meshonet_cli.options.boundary_layer import LayerOptions
from meshonet_cli.options.checks import CheckOptions, GateOptions
from meshonet_cli.options.engine import EngineOptions
from meshonet_cli.options.io import FileOptions, InputOptions, PrintOptions, Threads
from meshonet_cli.options.sampling import SamplingOptions

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.request import GridRequest
    from meshonet_cli.batch.run import Batch


@dataclass(frozen=True)
class GridOptions:
    """What boundaries become grids, how they are checked, and where they go."""

    many: InputOptions
    sampling: SamplingOptions
    first: LayerOptions
    checks: CheckOptions
    gates: GateOptions
    files: FileOptions
    printing: PrintOptions
    workers: EngineOptions
    threads: Threads = None

    def batch(self, boundary: Sequence[str]) -> Batch:
        """Return the run over boundaries."""
        return self.printing.batch(self.many.of(boundary), self.files, self.workers)

    def request(self, method: str, settings: Mapping[str, Any], *blocks: object, **more: Any) -> GridRequest:
        """Return what is asked of the grids, `blocks` of options and `more` by the names of its fields.

        Raises InputError: as `GridRequest`.
        """
        from meshonet.solvers.pipeline.request import GridRequest

        for block in (self.first, self.checks, *blocks):
            more |= vars(block)
        given = {name: value for name, value in settings.items() if value is not None}
        percentiles = self.gates.criteria().percentiles
        return GridRequest(
            self.sampling.settings(), method, given, percentiles=percentiles, threads=self.threads, **more
        )
