"""A grid drawn to a file, its cells coloured by a quality metric."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from meshonet.formats.figure.layers import DOTS
from meshonet.formats.figure.slices import parse_slice
from meshonet.formats.format import only_one
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, meant
from meshonet.geometry.quality.measure import per_cell_of_blocks
from meshonet.geometry.quality.metrics import ALL_NAMES, metric_of


@dataclass(frozen=True)
class Picture:
    """How a grid is drawn.

    Parameters
    ----------
    metric : colours the cells; None draws lines only.
    zoom : x0, x1, y0, y1 of the part to show, with z0, z1 of one in space; None shows all.
    every : draw every so many-th grid line; None chooses by the resolution of the picture.
    slice : of a volume, ``i=10``, ``k=-1`` or ``x=.5``; None draws walls, or the outer boundary without any.
    seen_from : azimuth and elevation in degrees, of pictures in space.

    Raises InputError: a metric or a slice that is none, a box without extent, `every` below 1.
    """

    metric: str | None = "max_angle"
    zoom: tuple[float, ...] | None = None
    every: int | None = None
    slice: str | None = None
    seen_from: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.metric not in (*ALL_NAMES, None):
            known = meant(str(self.metric), ALL_NAMES) + "use none or one of " + ", ".join(ALL_NAMES)
            raise InputError(f"metric {self.metric!r} is not known", known, parameter="metric")
        zoom = self.zoom or (0, 1, 0, 1)
        pairs = list(zip(zoom[::2], zoom[1::2], strict=False))
        if len(zoom) not in (4, 6) or not all(math.isfinite(a + b) and a < b for a, b in pairs):
            box = ",".join(f"{x:g}" for x in zoom)
            remedy = "use x0,x1,y0,y1 with x0 < x1 and y0 < y1, e.g. 0.9,1.1,-0.1,0.1"
            raise InputError(f"{box!r} is not a box", remedy, parameter="zoom")
        if self.slice is not None:
            parse_slice(self.slice)
        if self.seen_from is not None and not all(map(math.isfinite, self.seen_from)):
            remedy = "use azimuth and elevation in degrees, e.g. -125,25"
            raise InputError(f"{self.seen_from} is no direction", remedy, parameter="seen_from")
        if self.every is not None and self.every < 1:
            problem = f"every {self.every}-th line cannot be drawn"
            raise InputError(problem, "use 1 or more", parameter="every")

    def draw(self, kind: str, path: Path | BinaryIO, grids: Iterable[Grid], dots: int = DOTS) -> None:
        """Draw the only grid of `grids` to `path`, as ``png``, ``svg`` or ``pdf``, or as an ``html`` page.

        Pages go to a path only, pictures also to an open file; `dots` are those an inch of a ``png``.
        """
        from meshonet.formats.figure.files import write
        from meshonet.formats.figure.layers import Colouring
        from meshonet.formats.figure.page.page import write_page
        from meshonet.formats.figure.view import View

        grid = only_one(grids, "a picture")
        part = None if self.slice is None else parse_slice(self.slice)
        view = View(self.zoom, self.every, part, self.seen_from)
        if kind == "html" and isinstance(path, Path):
            write_page(path, grid, self.metric, view)
            return
        colouring = None
        if self.metric is not None:
            metric = metric_of(grid, self.metric)
            label = f"{metric.name} ({metric.unit})" if metric.unit else metric.name
            values = tuple(per_cell_of_blocks(grid, metric.name))
            colouring = Colouring(values, label, worst_is_low=metric.worst == "min")
        write(path, grid, kind, colouring, view, dots)
