"""Task of `convert`."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from textwrap import shorten

from meshonet.formats.convert import Conversion, plot3d_variant, unused_iblank
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import count_folded_in
from meshonet.geometry.quality.report import checkmesh_notes
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import Batch, BatchTask, each
from meshonet_cli.report.delivered import Delivered, delivered, part_names
from meshonet_cli.terminal.session import Session
from meshonet_cli.terminal.text import aligned


def convert_files(batch: Batch, conversion: Conversion, plot3d: str | None = None) -> int:
    """Convert the inputs of a batch and return the exit code; `plot3d` has options of the Plot3D format."""
    files = batch.files
    first = batch.inputs.first()
    from_format, to_format = plot3d_variant(plot3d, first, files.output, files.from_format, files.to_format)
    boundaries = conversion.of_boundaries(first, files.output, from_format, to_format)
    put = None if boundaries else conversion.extruder(files.output, to_format)
    read = partial(conversion.read, fmt=from_format, boundaries=boundaries)
    make = each(_converted, conversion=conversion, warn=batch.session.warn)
    task = BatchTask(read, make, "boundaries" if boundaries else "grids", put)
    return replace(batch, files=replace(files, to_format=to_format)).run(task)


def _converted(
    item: Item[Grid | Boundary], conversion: Conversion, warn: Callable[[str], None]
) -> tuple[Grid | Boundary, Delivered]:
    what = conversion(item.what)
    note = unused_iblank(item.what)
    if note:
        warn(f"{item.label}: {note}")
    folded = count_folded_in(what) if isinstance(what, Grid) else 0
    if folded:
        warn(f"{item.label}: the grid has {folded} folded cells; they are written as they are")
    notes: tuple[str, ...] = ()
    if conversion.coarsen > 1 and isinstance(what, Grid):
        notes = checkmesh_notes(what, conversion.coarsen)
    return what, delivered(item, what, part_names(what), notes=notes)


def print_formats(session: Session) -> int:
    """Print a table of all formats, or a JSON object for each, and return the exit code.

    The table shows only the beginning of a long list of extensions.
    """
    from meshonet.formats.catalogue import rows

    if session.as_json:
        for row in rows():
            session.result(row)
    else:
        short = [row | {"endings": shorten(row["endings"], 40, placeholder=" ...")} for row in rows()]
        session.print(aligned([list(short[0]), *(list(row.values()) for row in short)], left=len(short[0])))
    return session.finish()
