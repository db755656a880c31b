"""The pictures of `plot`, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from meshonet.formats.figure.picture import Picture, picture_format
from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import deliver, one_by_one, prepare
from meshonet_cli.batch.sources import items
from meshonet_cli.batch.timed import Timed
from meshonet_cli.session import Session


@dataclass
class Drawn(Timed):
    """The report of a picture."""

    grid: Grid
    metric: str | None

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        grid = self.grid
        facts = {"ni": grid.ni, "nj": grid.nj, "topology": grid.topology, "metric": self.metric}
        return {**self.member_json(), **facts, "seconds": self.times_json()}

    def line(self) -> str:
        """Return it for people."""
        colours = f"coloured by {self.metric}" if self.metric else "lines"
        size = f"{self.grid.ni} x {self.grid.nj} nodes"
        return f"{self.item.label} -> {self.output}: {size}, {colours}, {self.times()}"

    lines = line


def plot_grids(
    sources: Sequence[str], output: str, picture: Picture, session: Session, *,
    from_format: str | None = None, to_format: str | None = None, skip_existing: bool = False,
) -> int:  # fmt: skip
    """Draw every grid of `sources` to `output` and return the exit code.

    Raises
    ------
    InputError
        `output` is no picture, or holds one and there are several grids.
    """
    destination = picture_file(output, to_format, picture)
    prepare(sources, destination, session)

    def make(item: Item[Grid]) -> tuple[Grid, Drawn]:
        return item.what, Drawn(item, item.what, picture.metric)

    grids = items(sources, lambda source: read_grids(source, from_format), session)
    deliver(grids, one_by_one(make), destination, session, session.written, skip_existing=skip_existing)
    return session.finish()


def picture_file(output: str, to_format: str | None, picture: Picture) -> Destination:
    """Return the destination of `picture`.

    Raises
    ------
    InputError
        `output` is no picture.
    """
    kind = picture_format(output, to_format).name
    return Destination(output, kind, put=partial(picture.draw, kind))
