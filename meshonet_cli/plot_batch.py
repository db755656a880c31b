"""The pictures of `plot`, one after the other."""

from functools import partial

from meshonet.formats.figure.picture import Picture, picture_format
from meshonet.formats.inputs import Inputs
from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import process
from meshonet_cli.batch.sources import items
from meshonet_cli.batch.timed import Delivered
from meshonet_cli.session import Session


def plot_grids(
    inputs: Inputs, output: str, picture: Picture, session: Session, *,
    from_format: str | None = None, to_format: str | None = None, skip_existing: bool = False,
) -> int:  # fmt: skip
    """Draw every grid of `inputs` to `output` and return the exit code.

    Raises InputError: `output` is no picture, or holds one and there are several grids.
    """
    destination = picture_file(output, to_format, picture)
    colours = f"coloured by {picture.metric}" if picture.metric else "lines"

    def make(item: Item[Grid]) -> tuple[Grid, Delivered]:
        return item.what, Delivered(item, item.what, {"metric": picture.metric}, colours)

    grids = items(inputs, partial(read_grids, fmt=from_format), session)
    return process(grids, make, destination, session, skip_existing=skip_existing)


def picture_file(output: str, to_format: str | None, picture: Picture) -> Destination:
    """Return the destination of `picture`.

    Raises InputError: `output` is no picture.
    """
    kind = picture_format(output, to_format).name
    return Destination(output, kind, put=partial(picture.draw, kind))
