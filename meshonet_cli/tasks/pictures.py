"""Task of `plot`."""

import sys
from dataclasses import replace
from functools import partial
from typing import Any

from meshonet.formats.figure.picture import Picture
from meshonet.formats.registry import picture_format, read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import Batch, BatchTask, each
from meshonet_cli.report.delivered import Delivered, delivered


def plot_grids(batch: Batch, picture: Picture) -> int:
    """Draw each grid and return the exit code. Raises InputError if the output is not a picture file."""
    kind = picture_format(batch.files.output, batch.files.to_format).name
    leave_out_docstrings()
    read = partial(read_grids, fmt=batch.files.from_format)
    files = replace(batch.files, to_format=kind)
    return replace(batch, files=files).run(
        BatchTask(read, each(_drawn, metric=picture.metric), put=partial(picture.draw, kind))
    )


def _drawn(item: Item[Grid], metric: str | None) -> tuple[Grid, Delivered]:
    colours = f"coloured by {metric}" if metric else "lines"
    return item.what, delivered(item, item.what, {"metric": metric}, colours)


def leave_out_docstrings() -> None:
    """Import Matplotlib without its generated docstrings, which take a fifth of a picture's time."""
    if "matplotlib.figure" in sys.modules:
        return
    from matplotlib import artist

    own: Any = artist
    own.Artist._update_set_signature_and_docstring = classmethod(lambda _: None)
    own.kwdoc = lambda _: ""
