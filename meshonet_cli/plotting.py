"""What `plot` does with each grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import deliver, one_by_one, prepare
from meshonet_cli.batch.sources import items
from meshonet_cli.report import Timed
from meshonet_cli.session import Session


@dataclass
class Drawn(Timed):
    """What there is to tell of a picture."""

    grid: Grid
    metric: str | None

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        facts = {
            "ni": self.grid.ni,
            "nj": self.grid.nj,
            "topology": self.grid.topology,
            "metric": self.metric,
        }
        return {**self.member_json(), **facts, "seconds": self.times_json()}

    def line(self) -> str:
        """Return it for people."""
        colours = f"coloured by {self.metric}" if self.metric else "lines"
        size = f"{self.grid.ni} x {self.grid.nj} nodes"
        return f"{self.item.label} -> {self.output}: {size}, {colours}, {self.times()}"

    lines = line


def plot_grids(
    sources: Sequence[str],
    destination: Destination,
    metric: str | None,
    session: Session,
    *,
    fmt: str | None = None,
    skip_existing: bool = False,
) -> int:
    """Draw every grid of `sources` to `destination`, which knows how, and return the exit code."""
    prepare(sources, destination, session)

    def make(item: Item[Grid]) -> tuple[Grid, Drawn]:
        return item.what, Drawn(item, item.what, metric)

    def tell(report: Drawn, path: str) -> None:
        report.finished(path)
        session.tell(report)

    found = items(sources, lambda source: read_grids(source, fmt), session)
    deliver(found, one_by_one(make), destination, session, tell, skip_existing=skip_existing)
    return session.finish()
