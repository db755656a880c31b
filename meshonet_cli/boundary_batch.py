"""The boundaries of `sample-boundary`: from files, or drawn from a family."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from meshonet.formats.inputs import Inputs
from meshonet.formats.registry import read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.draw import Draw
from meshonet.geometry.shapes.shape import Shape, edges_of
from meshonet.geometry.spacing.sampling import Sampling
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.executors.engine import HERE, Engine
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import process
from meshonet_cli.batch.sources import DrawnInputs, Members, Origin, items
from meshonet_cli.batch.timed import Delivered, part_names
from meshonet_cli.session import Session

if TYPE_CHECKING:
    from meshonet_cli.options import FileOptions


EDGE_NODES = 1000
"""Nodes that the edges of a boundary have, as a rule."""


@dataclass(frozen=True)
class Sampler:
    """Samples members of a batch, and keeps so many boundary nodes as sensors."""

    sampling: Sampling
    sensors: int | None = None

    def __call__(self, item: Item[Shape]) -> tuple[Boundary, Delivered]:
        """Return the boundary of one shape and the report."""
        begun = time.perf_counter()
        boundary = edges_of(item.what, self.sampling)
        if self.sensors is not None:
            boundary = boundary.with_sensors(self.sensors)
        report = Delivered(item, boundary, part_names(boundary), notes=boundary.notes)
        report.seconds["boundary"] = time.perf_counter() - begun
        return boundary, report


def write_boundaries(
    inputs: Inputs | DrawnInputs, output: str, sampler: Sampler, files: FileOptions, session: Session, *,
    engine: Engine = HERE,
) -> int:  # fmt: skip
    """Sample the shapes of `inputs`, files or members of a family, into `output`; return the exit code.

    Raises InputError: a format without room for sensors, or for several members.
    """
    destination = Destination(
        output, files.to_format, "boundaries", part_size=files.part_size, nodes=EDGE_NODES
    )
    if sampler.sensors is not None and destination.format.name != "hdf5":
        raise InputError("only HDF5 keeps sensors", "write an .h5 file", parameter="sensors")
    members: Members[Any] = (
        drawn_items(inputs, session)
        if isinstance(inputs, DrawnInputs)
        else items(inputs, partial(read_shapes, fmt=files.from_format), session)
    )
    return process(members, sampler, destination, session, skip_existing=files.skip_existing, engine=engine)


def drawn_items(inputs: DrawnInputs, session: Session) -> Members[Draw]:
    """Return the members of a family."""
    return Members(_drawn(inputs, session), Origin(inputs, itself))


def _drawn(inputs: DrawnInputs, session: Session) -> Iterator[Item[Draw]]:
    session.batch = len(inputs.draws) > 1
    for member in inputs.own():
        session.begin(member.kind, len(inputs.draws) // inputs.shard[1] if session.batch else None)
        yield Item(member.index, member.kind, member, 0.0, not session.batch)


def itself(member: Draw) -> Iterator[Draw]:
    """Yield what a member of a family holds, itself."""
    return iter([member])
