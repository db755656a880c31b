"""What `sample-boundary` does with each shape."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from meshonet.formats.registry import read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.shape import Shape, edges_of
from meshonet.geometry.spacing.sampling import Sampling
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import deliver, one_by_one, prepare
from meshonet_cli.batch.sources import items
from meshonet_cli.batch.timed import Timed
from meshonet_cli.session import Session


@dataclass
class Sampled(Timed):
    """What there is to tell of a boundary."""

    boundary: Boundary

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        edges = self.boundary
        parts = [part.name for part in edges.patches]
        facts = {"ni": edges.ni, "nj": edges.nj, "topology": edges.topology, "parts": parts}
        told = {"notes": list(edges.notes)} if edges.notes else {}
        return {**self.member_json(), **facts, **told, "seconds": self.times_json()}

    def line(self) -> str:
        """Return it for people."""
        size = f"{self.boundary.ni} x {self.boundary.nj} nodes, {self.boundary.topology}"
        return "\n  ".join(
            [f"{self.item.label} -> {self.output}: {size}, {self.times()}", *self.boundary.notes]
        )

    lines = line


@dataclass(frozen=True)
class Sampler:
    """Samples shapes."""

    sampling: Sampling
    sensors: int | None = None

    def boundary(self, item: Item[Shape]) -> tuple[Boundary, Sampled]:
        """Return the boundary of one shape and what there is to tell of it."""
        begun = time.perf_counter()
        boundary = edges_of(item.what, self.sampling)
        if self.sensors is not None:
            boundary = boundary.with_sensors(self.sensors)
        report = Sampled(item, boundary)
        report.seconds["boundary"] = time.perf_counter() - begun
        return boundary, report


def from_files(
    sources: Sequence[str], output: str, to_format: str | None, session: Session, fmt: str | None
) -> tuple[Iterator[Item[Any]], Destination]:
    """Return the shapes of `sources` (in format `fmt`, or None to find out) and where they go."""
    destination = Destination(output, to_format, "boundaries")
    prepare(sources, destination, session)
    return items(sources, lambda source: read_shapes(source, fmt), session), destination


def from_family(
    drawn: tuple[str, int, str | None, int, str | None], output: str, to_format: str | None, session: Session
) -> tuple[Iterator[Item[Any]], Destination]:
    """Return members of a family and where they go.

    Parameters
    ----------
    drawn : family, count, range, seed and split, as `meshonet.geometry.families.draw.draws` takes them.
    """
    from meshonet.geometry.families.draw import draws

    members = draws(*drawn)
    session.batch = len(members) > 1
    destination = Destination(output, to_format, "boundaries")
    prepare([drawn[0]], destination, session)

    def items() -> Iterator[Item[Any]]:
        for member in members:
            session.begin(drawn[0], len(members) if session.batch else None)
            yield Item(member.index, drawn[0], member, 0.0, not session.batch)

    return items(), destination


def sample(
    found: Iterator[Item[Any]],
    sampling: Sampling,
    destination: Destination,
    session: Session,
    *,
    sensors: int | None = None,
    skip_existing: bool = False,
    jobs: int = 1,
) -> int:
    """Sample every shape of `found` into `destination`, with `sensors` each, and return the exit code.

    Raises
    ------
    InputError
        sensors, and a format without room for them.
    """
    if sensors is not None and destination.format.name != "hdf5":
        raise InputError("only HDF5 keeps sensors", "write an .h5 file", parameter="sensors")

    def tell(report: Sampled, path: str) -> None:
        report.finished(path)
        session.tell(report)

    make = Sampler(sampling, sensors).boundary
    deliver(found, one_by_one(make), destination, session, tell, skip_existing=skip_existing, jobs=jobs)
    return session.finish()
