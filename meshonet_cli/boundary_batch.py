"""The boundaries of `sample-boundary`: from files, or drawn from a family."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

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
from meshonet_cli.batch.sources import items
from meshonet_cli.batch.timed import Delivered, part_names
from meshonet_cli.session import Session


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
    sources: Sequence[str] | Sequence[Draw], output: str, sampler: Sampler, session: Session, *,
    from_format: str | None = None, to_format: str | None = None, skip_existing: bool = False,
    engine: Engine = HERE,
) -> int:  # fmt: skip
    """Sample the shapes of `sources`, files or members of a family, into `output`; return the exit code.

    Raises InputError: a format without room for sensors, or for several members.
    """
    destination = Destination(output, to_format, "boundaries")
    if sampler.sensors is not None and destination.format.name != "hdf5":
        raise InputError("only HDF5 keeps sensors", "write an .h5 file", parameter="sensors")
    files = [source for source in sources if isinstance(source, str)]
    members: Iterator[Item[Any]] = items(files, lambda source: read_shapes(source, from_format), session)
    if not files:
        members = _drawn([source for source in sources if isinstance(source, Draw)], session)
    return process(files, members, sampler, destination, session, skip_existing=skip_existing, engine=engine)


def _drawn(members: Sequence[Draw], session: Session) -> Iterator[Item[Draw]]:
    session.batch = len(members) > 1
    for member in members:
        session.begin(member.kind, len(members) if session.batch else None)
        yield Item(member.index, member.kind, member, 0.0, not session.batch)
