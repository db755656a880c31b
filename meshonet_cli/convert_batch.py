"""The files of `convert`, one after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from meshonet.formats.convert import Conversion, plot3d_variant, unused_iblank
from meshonet.formats.inputs import Inputs
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import process
from meshonet_cli.batch.sources import items
from meshonet_cli.batch.timed import Delivered, part_names
from meshonet_cli.session import Session

if TYPE_CHECKING:
    from meshonet_cli.options import FileOptions


def convert_files(
    inputs: Inputs, output: str, conversion: Conversion, files: FileOptions, session: Session, *,
    plot3d: str | None = None,
) -> int:  # fmt: skip
    """Write what `inputs` hold to `output` and return the exit code; `plot3d` is a variant of it."""
    from_format, to_format = plot3d_variant(plot3d, output, files.from_format, files.to_format)
    boundaries = conversion.of_boundaries(inputs.first(), output, from_format, to_format)
    put = None if boundaries else conversion.extruder(output, to_format)
    destination = Destination(
        output, to_format, "boundaries" if boundaries else "grids", put, part_size=files.part_size
    )

    read = partial(conversion.read, fmt=from_format, boundaries=boundaries)
    maker = Converter(conversion, session.warn)
    return process(
        items(inputs, read, session), maker, destination, session, skip_existing=files.skip_existing
    )


@dataclass(frozen=True)
class Converter:
    """Converts members of a batch; `warn` tells of what is lost."""

    conversion: Conversion
    warn: Callable[[str], None]

    def __call__(self, item: Item[Grid | Boundary]) -> tuple[Grid | Boundary, Delivered]:
        """Return what is to be written of one grid or boundary, and the report."""
        what = self.conversion(item.what)
        note = unused_iblank(item.what)
        if note:
            self.warn(f"{item.label}: {note}")
        return what, Delivered(item, what, part_names(what))


def print_formats(session: Session) -> int:
    """Print what every format can do, one JSON object each when asked, and return the exit code."""
    from meshonet.formats.catalogue import plain, rows

    if session.as_json:
        for row in rows():
            session.result(row)
    else:
        session.print(plain())
    return session.finish()
