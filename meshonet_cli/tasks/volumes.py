"""Task of `stack`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

from meshonet.formats.format import Space
from meshonet.formats.stack import stack_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import change_facts
from meshonet.geometry.sections.stack import Stack, Tip
from meshonet.solvers.pipeline.stacked import Sections, make_stacked, stacked_surface, with_tip
from meshonet.solvers.stages import stage
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.provenance import provenance
from meshonet_cli.batch.run import Batch, BatchTask, each
from meshonet_cli.report.delivered import Delivered, delivered, part_names
from meshonet_cli.tasks.grids import made_by

if TYPE_CHECKING:
    from meshonet.geometry.aircraft.aircraft import Aircraft
    from meshonet.geometry.quality.criteria import Criteria

VOLUME_NODES = 1_000_000  # assumed number of nodes of a volume, which is not known in advance


def write_stacks(
    batch: Batch, parameters: Mapping[str, Any], criteria: Criteria | None, *, tip: Tip | None, surface: bool
) -> int:
    """Make volumes (with `surface`, surfaces) from stacked sections, write them, return the exit code."""
    chosen = shared(parameters, batch, criteria)
    if surface and criteria:
        raise InputError("{fail_on} and {profile} judge cells, and a surface has none", "leave them out")
    batch.session.judges = criteria is not None
    volumes = each(made_by, solve=partial(make_stacked, **chosen), criteria=criteria)
    make = each(_surface, parameters=chosen) if surface else volumes
    space: Space = "surfaces" if surface else "volumes"
    read = partial(_stack, tip=tip, surface=surface)
    return batch.run(BatchTask(read, make, nodes=VOLUME_NODES, space=space))


def _stack(source: str, tip: Tip | None, surface: bool) -> Iterator[Sections]:
    return iter([with_tip(stack_of(source), tip, surface=surface)])


def _surface(item: Item[Stack | Aircraft], parameters: Mapping[str, Any]) -> tuple[Grid, Delivered]:
    seconds: dict[str, float] = {}
    with stage("grid", seconds):
        grid, notes = stacked_surface(item.what, **parameters)
    report = delivered(item, grid, part_names(grid), "surface", notes=notes)
    report.seconds |= seconds
    return grid.with_provenance(**change_facts(notes), **provenance()), report


def shared(parameters: Mapping[str, Any], batch: Batch, criteria: Criteria | None) -> dict[str, Any]:
    """Return `parameters` with a worker's number of threads, and with percentiles if criteria need them."""
    percentiles = criteria is not None and criteria.percentiles
    threads = batch.engine.threads(parameters.get("threads"))
    return {**parameters, "threads": threads, "percentiles": percentiles}
