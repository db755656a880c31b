"""The files of `convert`, one after the other."""

from __future__ import annotations

from collections.abc import Sequence

from meshonet.formats.convert import Conversion, plot3d_variant, unused_iblank
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import process
from meshonet_cli.batch.sources import items
from meshonet_cli.batch.timed import Delivered, part_names
from meshonet_cli.session import Session


def convert_files(
    sources: Sequence[str], output: str, conversion: Conversion, session: Session, *,
    from_format: str | None = None, to_format: str | None = None, plot3d: str | None = None,
    skip_existing: bool = False,
) -> int:  # fmt: skip
    """Write what `sources` hold to `output` and return the exit code.

    `plot3d`: variant of the Plot3D file among them. `skip_existing`: pass over members whose own file is
    there. Raises InputError: a format that cannot be written, or not in 3D; a height that is not positive.
    """
    from_format, to_format = plot3d_variant(plot3d, output, from_format, to_format)
    boundaries = conversion.of_boundaries(sources[0], output, from_format, to_format)
    put = None if boundaries else conversion.extruder(output, to_format)
    destination = Destination(output, to_format, "boundaries" if boundaries else "grids", put)

    def make(item: Item[Grid | Boundary]) -> tuple[Grid | Boundary, Delivered]:
        what = conversion(item.what)
        note = unused_iblank(item.what)
        if note:
            session.warn(f"{item.label}: {note}")
        return what, Delivered(item, what, part_names(what))

    members = items(
        sources, lambda source: conversion.read(source, from_format, boundaries=boundaries), session
    )
    return process(sources, members, make, destination, session, skip_existing=skip_existing)


def print_formats(session: Session) -> int:
    """Print what every format can do, one JSON object each when asked, and return the exit code."""
    from meshonet.formats.catalogue import plain, rows

    if session.as_json:
        for row in rows():
            session.result(row)
    else:
        session.print(plain())
    return session.finish()
