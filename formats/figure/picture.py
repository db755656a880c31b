"""A grid drawn to a file, its cells coloured by a quality metric."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from meshonet.formats.figure.layers import DOTS
from meshonet.formats.figure.view import View
from meshonet.formats.format import only_one
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, meant
from meshonet.geometry.quality.measure import per_cell_of_blocks
from meshonet.geometry.quality.metrics import ALL_NAMES, metric_of


@dataclass(frozen=True)
class Picture(View):
    """How a grid is drawn: what of it, and the `metric` that colours its cells; None draws lines only.

    Raises InputError: as `View`; a metric that is none.
    """

    metric: str | None = "max_angle"

    def __post_init__(self) -> None:
        if self.metric not in (*ALL_NAMES, None):
            known = meant(str(self.metric), ALL_NAMES) + "use none or one of " + ", ".join(ALL_NAMES)
            raise InputError(f"metric {self.metric!r} is not known", known, parameter="metric")
        super().__post_init__()

    def draw(self, kind: str, path: Path | BinaryIO, grids: Iterable[Grid], dots: int = DOTS) -> None:
        """Draw the only grid of `grids` to `path`, as ``png``, ``svg`` or ``pdf``, or as an ``html`` page.

        Pages go to a path only, pictures also to an open file; `dots` are those an inch of a ``png``.
        """
        from meshonet.formats.figure.files import write
        from meshonet.formats.figure.layers import Colouring
        from meshonet.formats.figure.page.page import write_page

        grid = only_one(grids, "a picture")
        if kind == "html" and isinstance(path, Path):
            write_page(path, grid, self.metric, self)
            return
        colouring = None
        if self.metric is not None:
            metric = metric_of(grid, self.metric)
            label = f"{metric.name} ({metric.unit})" if metric.unit else metric.name
            values = tuple(per_cell_of_blocks(grid, metric.name))
            colouring = Colouring(values, label, worst_is_low=metric.worst == "min")
        write(path, grid, kind, colouring, self, dots)
