"""Options of the commands that make grids from boundaries."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from meshonet_cli.options.boundary_layer import LayerOptions, at_walls
from meshonet_cli.options.checks import GateOptions, LeaveOutFailed
from meshonet_cli.options.io import FileOptions, RunOptions, Threads
from meshonet_cli.options.sampling import SamplingOptions

if TYPE_CHECKING:
    from meshonet.solvers.pipeline.request import GridRequest


@dataclass(frozen=True, kw_only=True)
class GridOptions(RunOptions, GateOptions, FileOptions):
    """Options for making, judging and writing grids."""

    leave_out_failed: LeaveOutFailed = False
    threads: Threads = None

    def request(
        self, method: str, settings: Mapping[str, Any], sampling: SamplingOptions, layers: LayerOptions,
        *blocks: object, **more: Any,
    ) -> "GridRequest":  # fmt: skip
        """Return the request for the grids, from blocks of options and additional fields `more`.

        Raises InputError: see `GridRequest`.
        """
        from meshonet.solvers.pipeline.request import GridRequest

        for block in (layers, *blocks):
            more |= vars(block)
        for name in ("first_cell", "y_plus"):
            if more[name] is not None:
                more[name] = at_walls(more[name], name)
        chosen: dict[str, Any] = {}
        for name, value in settings.items():
            if value is not None:
                chosen[name] = value
        return GridRequest(sampling.placed(more), method, chosen, threads=self.threads, **more)
