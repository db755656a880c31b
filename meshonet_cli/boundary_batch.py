"""The boundaries of `sample-boundary`: from files, or drawn from a family."""

from __future__ import annotations

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
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import deliver, one_by_one, prepare
from meshonet_cli.batch.sources import items
from meshonet_cli.batch.timed import Timed
from meshonet_cli.errors import with_options
from meshonet_cli.session import Session


@dataclass
class Sampled(Timed):
    """The report of a boundary."""

    boundary: Boundary

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        edges = self.boundary
        parts = [patch.name for patch in edges.patches]
        facts = {"ni": edges.ni, "nj": edges.nj, "topology": edges.topology, "parts": parts}
        notes = {"notes": [with_options(note) for note in edges.notes]} if edges.notes else {}
        return {**self.member_json(), **facts, **notes, "seconds": self.times_json()}

    def line(self) -> str:
        """Return it for people."""
        size = f"{self.boundary.ni} x {self.boundary.nj} nodes, {self.boundary.topology}"
        head = f"{self.item.label} -> {self.output}: {size}, {self.times()}"
        return "\n  ".join([head, *map(with_options, self.boundary.notes)])

    lines = line


@dataclass(frozen=True)
class Sampler:
    """Samples members of a batch, and keeps so many boundary nodes as sensors."""

    sampling: Sampling
    sensors: int | None = None

    def __call__(self, item: Item[Shape]) -> tuple[Boundary, Sampled]:
        """Return the boundary of one shape and the report."""
        begun = time.perf_counter()
        boundary = edges_of(item.what, self.sampling)
        if self.sensors is not None:
            boundary = boundary.with_sensors(self.sensors)
        report = Sampled(item, boundary)
        report.seconds["boundary"] = time.perf_counter() - begun
        return boundary, report


def write_boundaries(
    sources: Sequence[str] | Sequence[Draw], output: str, sampler: Sampler, session: Session, *,
    from_format: str | None = None, to_format: str | None = None, skip_existing: bool = False, jobs: int = 1,
) -> int:  # fmt: skip
    """Sample the shapes of `sources`, files or members of a family, into `output`; return the exit code.

    Raises
    ------
    InputError
        a format without room for sensors, or for several members.
    """
    destination = Destination(output, to_format, "boundaries")
    if sampler.sensors is not None and destination.format.name != "hdf5":
        raise InputError("only HDF5 keeps sensors", "write an .h5 file", parameter="sensors")
    files = [source for source in sources if isinstance(source, str)]
    prepare(files, destination, session)
    members: Iterator[Item[Any]] = items(files, lambda source: read_shapes(source, from_format), session)
    if not files:
        members = _drawn([source for source in sources if isinstance(source, Draw)], session)
    deliver(
        members, one_by_one(sampler), destination, session, session.written,
        skip_existing=skip_existing, jobs=jobs,
    )  # fmt: skip
    return session.finish()


def _drawn(members: Sequence[Draw], session: Session) -> Iterator[Item[Draw]]:
    session.batch = len(members) > 1
    for member in members:
        session.begin(member.kind, len(members) if session.batch else None)
        yield Item(member.index, member.kind, member, 0.0, not session.batch)
