"""The files of `convert`, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from meshonet.formats.convert import Conversion, plot3d_variant, unused_iblank
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import deliver, one_by_one, prepare
from meshonet_cli.batch.sources import items
from meshonet_cli.batch.timed import Timed
from meshonet_cli.session import Session


@dataclass
class Converted(Timed):
    """The report of a file that was converted."""

    what: Grid | Boundary

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        what, parts = self.what, [patch.name for patch in self.what.patches]
        facts = {"ni": what.ni, "nj": what.nj, "topology": what.topology, "parts": parts}
        return {**self.member_json(), **facts, "seconds": self.times_json()}

    def line(self) -> str:
        """Return it for people."""
        size = f"{self.what.ni} x {self.what.nj} nodes, {self.what.topology}"
        return f"{self.item.label} -> {self.output}: {size}, {self.times()}"

    lines = line


def convert_files(
    sources: Sequence[str], output: str, conversion: Conversion, session: Session, *,
    from_format: str | None = None, to_format: str | None = None, plot3d: str | None = None,
    skip_existing: bool = False,
) -> int:  # fmt: skip
    """Write what `sources` hold to `output` and return the exit code.

    Parameters
    ----------
    plot3d : variant of the Plot3D file that is written, or else read.
    skip_existing : skip members whose output file exists already.

    Raises
    ------
    InputError
        a format that cannot be written, or cannot hold 3D grids; a height that is not positive.
    """
    from_format, to_format = plot3d_variant(plot3d, output, from_format, to_format)
    boundaries = conversion.of_boundaries(sources[0], output, from_format, to_format)
    put = None if boundaries else conversion.extruder(output, to_format)
    destination = Destination(output, to_format, "boundaries" if boundaries else "grids", put)
    prepare(sources, destination, session)

    def make(item: Item[Grid | Boundary]) -> tuple[Grid | Boundary, Converted]:
        what = conversion(item.what)
        note = unused_iblank(item.what)
        if note:
            session.warn(f"{item.label}: {note}")
        return what, Converted(item, what)

    members = items(
        sources, lambda source: conversion.read(source, from_format, boundaries=boundaries), session
    )
    deliver(members, one_by_one(make), destination, session, session.written, skip_existing=skip_existing)
    return session.finish()


def print_formats(session: Session) -> int:
    """Print what every format can do, one JSON object each when asked, and return the exit code."""
    from meshonet.formats.catalogue import plain, rows

    if session.as_json:
        for row in rows():
            session.result(row)
    else:
        session.print(plain())
    return session.finish()
