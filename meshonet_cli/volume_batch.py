"""The volumes of `stack` and `sweep`, one after the other."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from meshonet.api.grid import domain_parameters
from meshonet.formats.inputs import Inputs
from meshonet.formats.path import path_of
from meshonet.formats.section import read_sections
from meshonet.formats.stack import stack_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.curves.path import Path
from meshonet.geometry.errors import InputError
from meshonet.geometry.notes import change_facts
from meshonet.geometry.quality.criteria import Criteria
from meshonet.geometry.sections.stack import Stack, Tip
from meshonet.geometry.shapes.shape import Shape
from meshonet.solvers.pipeline.parameters import grid_request
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.stacks import make_stack, stack_surface
from meshonet.solvers.pipeline.sweeps import make_sweep
from meshonet.solvers.stacking.request import StackRequest, stack_request
from meshonet.solvers.sweeping.sweep import Sweep
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.executors.engine import HERE, Engine
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import process
from meshonet_cli.batch.sources import Members, items
from meshonet_cli.batch.timed import Delivered, part_names
from meshonet_cli.grid_batch import judging, reported
from meshonet_cli.options.groups import bad_value
from meshonet_cli.options.sampling import resolution
from meshonet_cli.provenance import provenance
from meshonet_cli.report.grid import Report
from meshonet_cli.session import Session

VOLUME_NODES = 1_000_000
"""Nodes of a volume, about; how many there will be is known when it is made."""


def write_stacks(
    inputs: Inputs, output: str, parameters: Mapping[str, Any], session: Session, *,
    tip: Tip | None = None, surface: bool = False, criteria: Criteria = Criteria(),
    to_format: str | None = None, skip_existing: bool = False, engine: Engine = HERE,
) -> int:  # fmt: skip
    """Write the volumes, or the surfaces, of the stacks of `inputs` and return the exit code."""
    request = stack_request(**_shared(parameters, engine), percentiles=criteria.percentiles)
    members = items(inputs, partial(_stack, tip=tip), session)
    if surface:
        if criteria:
            raise InputError("{fail_on} and {profile} judge cells, and a surface has none", "leave them out")
        destination = Destination(output, to_format, "grids", nodes=VOLUME_NODES)
        return process(
            members, _Surfaces(request), destination, session, skip_existing=skip_existing, engine=engine
        )
    return _write(members, _Stacks(request, criteria), output, session, to_format, skip_existing, engine)


def _stack(source: str, tip: Tip | None) -> Iterator[Stack]:
    return iter([stack_of(source).with_tip(tip)])


def write_sweeps(
    inputs: Inputs, path: str, output: str, res: str | None, section: Mapping[str, Any],
    along: Mapping[str, Any], session: Session, *, criteria: Criteria = Criteria(),
    from_format: str | None = None, to_format: str | None = None, skip_existing: bool = False,
    engine: Engine = HERE,
) -> int:  # fmt: skip
    """Write the volumes of the sections of `inputs` along a path; return the exit code."""
    parameters = domain_parameters(_shared(section, engine))
    parameters["percentiles"] = criteria.percentiles
    request = grid_request(res=None if res is None else _counts(res), **parameters)
    make = _Sweeps(path_of(path), request, Sweep(**along), criteria)
    members = items(inputs, partial(read_sections, fmt=from_format), session)
    return _write(members, make, output, session, to_format, skip_existing, engine)


def _counts(text: str) -> tuple[int, int]:
    ni, nj, nk = resolution(text)
    if nk is not None:
        raise bad_value(text, "the nodes of a section", "use NIxNJ, and {planes} along the path", "res")
    return ni, nj


def vector(text: str | None) -> tuple[float, float, float] | None:
    """Return the vector ``X,Y,Z``, or raise InputError.

    >>> vector("0,0,1")
    (0.0, 0.0, 1.0)
    """
    if text is None:
        return None
    try:
        x, y, z = (float(word) for word in text.split(","))
    except ValueError:
        raise bad_value(text, "a direction", "use X,Y,Z, e.g. 0,0,1", "up") from None
    return x, y, z


def _shared(parameters: Mapping[str, Any], engine: Engine) -> dict[str, Any]:
    """Return parameters, the cores shared out among the workers of the engine."""
    return {**parameters, "threads": engine.threads(parameters.get("threads"))}


def _write(
    members: Members[Any], make: Callable[[Any], tuple[Grid, Report]],
    output: str, session: Session, to_format: str | None, skip_existing: bool,
    engine: Engine,
) -> int:  # fmt: skip
    destination = Destination(output, to_format, "grids", nodes=VOLUME_NODES)
    return process(
        members, make, destination, session, written=judging(session), skip_existing=skip_existing,
        engine=engine,
    )  # fmt: skip


@dataclass(frozen=True)
class _Stacks:
    """Makes the volumes of stacks."""

    request: StackRequest
    criteria: Criteria

    def __call__(self, item: Item[Stack]) -> tuple[Grid, Report]:
        return reported(item, make_stack(item.what, self.request), self.criteria)  # type: ignore[arg-type]


@dataclass(frozen=True)
class _Sweeps:
    """Makes the volumes of sections along a path."""

    path: Path
    request: GridRequest
    settings: Sweep
    criteria: Criteria

    def __call__(self, item: Item[Shape]) -> tuple[Grid, Report]:
        volume = make_sweep(item.what, self.path, self.request, self.settings)
        return reported(item, volume, self.criteria)


@dataclass(frozen=True)
class _Surfaces:
    """Makes the surfaces of stacks."""

    request: StackRequest

    def __call__(self, item: Item[Stack]) -> tuple[Grid, Delivered]:
        begun = time.perf_counter()
        grid, notes = stack_surface(item.what, self.request)
        report = Delivered(item, grid, part_names(grid), "surface", notes=notes)
        report.seconds["grid"] = time.perf_counter() - begun
        return grid.with_provenance(**change_facts(notes), **provenance()), report
