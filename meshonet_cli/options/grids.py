"""Options of the commands that make grids from boundaries."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from meshonet_cli.options.boundary_layer import LayerOptions, at_walls
from meshonet_cli.options.checks import GateOptions, LeaveOutFailed
from meshonet_cli.options.groups import METHOD, bad_value, option_of
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
        """Return the request for grids; `blocks` are option groups, and `more` other fields of the request.

        Raises InputError as `GridRequest`.
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


# fmt: off
Refine = Annotated[int, option_of(METHOD)(
    metavar="K", min=0, max=8, help="Halve all cells K times, and solve again after each time. The finest "
    "grid is written; convert --coarsen extracts the others. --res, --wake-nodes, --cells and --cell-size "
    "apply to the coarsest grid; --first-cell, --growth and --base-nodes apply to the finest.",
)]
# fmt: on


def polish_steps(text: str) -> Literal["off"] | int:
    """Return the value of ``--polish``, ``off`` or a number. Raises InputError: other text.

    >>> polish_steps("off"), polish_steps("3")
    ('off', 3)
    """
    if text == "off":
        return "off"
    if not re.fullmatch(r"\d{1,3}", text, re.ASCII):
        raise bad_value(text, "a number of steps", "use auto, off or e.g. 2", "polish")
    return int(text)


def coarse_nodes(text: str) -> Literal["auto"] | int | None:
    """Return the value of ``--coarse``: ``auto``, None for ``off`` or 0, or a number of at least 9.

    Raises InputError: other text.

    >>> coarse_nodes("auto"), coarse_nodes("off"), coarse_nodes("65")
    ('auto', None, 65)
    """
    if text == "auto":
        return "auto"
    if text in ("off", "0"):
        return None
    if not re.fullmatch(r"[0-9]{1,6}", text) or int(text) < 9:
        raise bad_value(text, "a number of nodes from 9 on", "use auto, off or e.g. 65", "coarse")
    return int(text)
