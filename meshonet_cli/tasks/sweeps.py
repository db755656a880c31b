"""Task of `sweep`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from meshonet.api.grid import domain_parameters
from meshonet.formats.path import path_of
from meshonet.formats.registry import read_sections
from meshonet.geometry.blocks.revolve import Revolution
from meshonet.solvers.pipeline.parameters import grid_request
from meshonet.solvers.pipeline.sweeps import make_sweep
from meshonet.solvers.pipeline.uses import Counts
from meshonet.solvers.sweeping.sweep import Sweep
from meshonet_cli.batch.run import Batch, BatchTask, each
from meshonet_cli.options.groups import bad_value
from meshonet_cli.options.sampling import resolution
from meshonet_cli.tasks.grids import made_by
from meshonet_cli.tasks.volumes import VOLUME_NODES, shared

if TYPE_CHECKING:
    from meshonet.geometry.quality.criteria import Criteria


def write_sweeps(
    batch: Batch, path: str | Revolution, section: Mapping[str, Any], settings: Sweep,
    criteria: Criteria | None, *, around: int | None = None,
) -> int:  # fmt: skip
    """Sweep sections along a path or about an axis, write the volumes, and return the exit code."""
    parameters = domain_parameters(shared(section, batch, criteria))
    res = parameters.pop("res")
    request = grid_request(res=None if res is None else _counts(res), **parameters)
    way = path_of(path) if isinstance(path, str) else path
    batch.session.judges = criteria is not None
    swept = partial(make_sweep, path=way, request=request, settings=settings, around=around)
    make = each(made_by, solve=swept, criteria=criteria)
    read = partial(read_sections, fmt=batch.files.from_format)
    return batch.run(BatchTask(read, make, nodes=VOLUME_NODES, space="volumes"))


def _counts(text: str) -> Counts:
    counts = resolution(text)
    if not isinstance(counts, int) and len(counts) == 3:
        raise bad_value(text, "the nodes of a section", "use NIxNJ, and {planes} along the path", "res")
    return counts
