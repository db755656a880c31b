"""Tasks of `stack` and `sweep`."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

from meshonet.api.grid import domain_parameters
from meshonet.formats.cross_section import read_sections
from meshonet.formats.format import Space
from meshonet.formats.path import path_of
from meshonet.formats.stack import stack_of
from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.revolve import Revolution
from meshonet.geometry.curves.path import Path
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import change_facts
from meshonet.geometry.quality.criteria import Criteria
from meshonet.geometry.sections.stack import Stack, Tip
from meshonet.geometry.shapes.shape import Shape
from meshonet.solvers.pipeline.parameters import grid_request
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.stacked import Sections, make_stacked, stacked_surface, with_tip
from meshonet.solvers.pipeline.sweeps import make_sweep
from meshonet.solvers.pipeline.uses import Counts
from meshonet.solvers.stages import stage
from meshonet.solvers.sweeping.sweep import Sweep
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.provenance import provenance
from meshonet_cli.batch.run import Batch, BatchTask, each
from meshonet_cli.options.groups import bad_value
from meshonet_cli.options.sampling import resolution
from meshonet_cli.report.delivered import Delivered, delivered, part_names
from meshonet_cli.report.grid import Report
from meshonet_cli.tasks.grids import reported

VOLUME_NODES = 1_000_000
"""Assumed number of nodes of a volume, which is not known in advance."""


def write_stacks(
    batch: Batch, parameters: Mapping[str, Any], criteria: Criteria | None, *, tip: Tip | None, surface: bool
) -> int:
    """Write the volumes or surfaces of the stacks and return the exit code."""
    chosen = _shared(parameters, batch, criteria)
    if surface and criteria:
        raise InputError("{fail_on} and {profile} judge cells, and a surface has none", "leave them out")
    batch.session.judges = criteria is not None
    volumes = each(_stacked, parameters=chosen, criteria=criteria)
    make = each(_surface, parameters=chosen) if surface else volumes
    space: Space = "surfaces" if surface else "volumes"
    read = partial(_stack, tip=tip, surface=surface)
    return batch.run(BatchTask(read, make, nodes=VOLUME_NODES, space=space))


def _stack(source: str, tip: Tip | None, surface: bool) -> Iterator[Sections]:
    return iter([with_tip(stack_of(source), tip, surface=surface)])


def _stacked(
    item: Item[Sections], parameters: Mapping[str, Any], criteria: Criteria | None
) -> tuple[Grid, Report]:
    return reported(item, make_stacked(item.what, **parameters), criteria)


def _surface(item: Item[Stack | Aircraft], parameters: Mapping[str, Any]) -> tuple[Grid, Delivered]:
    seconds: dict[str, float] = {}
    with stage("grid", seconds):
        grid, notes = stacked_surface(item.what, **parameters)
    report = delivered(item, grid, part_names(grid), "surface", notes=notes)
    report.seconds |= seconds
    return grid.with_provenance(**change_facts(notes), **provenance()), report


def write_sweeps(
    batch: Batch, path: str | Revolution, section: Mapping[str, Any], settings: Sweep,
    criteria: Criteria | None, *, around: int | None = None,
) -> int:  # fmt: skip
    """Write the volumes of sections that are swept along a path or about an axis; return the exit code."""
    parameters = domain_parameters(_shared(section, batch, criteria))
    res = parameters.pop("res")
    request = grid_request(res=None if res is None else _counts(res), **parameters)
    way = path_of(path) if isinstance(path, str) else path
    batch.session.judges = criteria is not None
    make = each(_swept, path=way, request=request, settings=settings, criteria=criteria, around=around)
    read = partial(read_sections, fmt=batch.files.from_format)
    return batch.run(BatchTask(read, make, nodes=VOLUME_NODES, space="volumes"))


def _swept(
    item: Item[Shape], path: Path | Revolution, request: GridRequest, settings: Sweep,
    criteria: Criteria | None, around: int | None,
) -> tuple[Grid, Report]:  # fmt: skip
    return reported(item, make_sweep(item.what, path, request, settings, around), criteria)


def _counts(text: str) -> Counts:
    counts = resolution(text)
    if not isinstance(counts, int) and len(counts) == 3:
        raise bad_value(text, "the nodes of a section", "use NIxNJ, and {planes} along the path", "res")
    return counts


def _shared(parameters: Mapping[str, Any], batch: Batch, criteria: Criteria | None) -> dict[str, Any]:
    """Return parameters with percentiles if the criteria need them; workers of the engine share the cores."""
    percentiles = criteria is not None and criteria.percentiles
    threads = batch.engine.threads(parameters.get("threads"))
    return {**parameters, "threads": threads, "percentiles": percentiles}
