"""Pictures of grids as files: ``.png``, ``.svg`` or ``.pdf``, with cells coloured by a quality metric."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from meshonet.formats.figure.layers import DOTS, Colouring
from meshonet.formats.figure.view import View, check_flat, flat_box
from meshonet.formats.format import only_one
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, meant
from meshonet.geometry.polygon.area import check_extent
from meshonet.geometry.quality.measure import per_cell_of_blocks
from meshonet.geometry.quality.metrics import ALL_NAMES, FACE_NAMES, LINE_METRIC, metric_of

DRAWN = (*ALL_NAMES, LINE_METRIC.name, *FACE_NAMES)  # names of the metrics by which cells can be coloured
_RATIO, _ANGLE = LINE_METRIC.name, "max_angle"
_RELATED = {
    "folded": "scaled_jacobian, which is 0 or less there",
    "bezier_folded": "bezier_ratio, which is 0 or less there",
    "growth_across": _RATIO,
    "wall_growth": _RATIO,
    "equal_wall_cells": _RATIO,
    "deviation_mean": _ANGLE,
    "deviation_p99": _ANGLE,
    "bend_across": _ANGLE,
    "far_field": "the whole grid",
    "irregular": "any metric: these vertices are marked",
}
"""Metrics whose picture shows where a figure of the whole grid occurs, by the figure."""


@dataclass(frozen=True)
class Picture(View):
    """A view and the metric that colours cells (None: lines only). Raises InputError: unknown metric."""

    metric: str | None = "max_angle"

    def __post_init__(self) -> None:
        if self.metric in _RELATED:
            remedy = f"draw {_RELATED[self.metric]}"
            raise InputError(f"{self.metric} is one figure of the whole grid", remedy, parameter="metric")
        if self.metric not in (*DRAWN, None):
            known = meant(str(self.metric), DRAWN) + "use none or one of " + ", ".join(DRAWN)
            raise InputError(f"metric {self.metric!r} is not known", known, parameter="metric")
        super().__post_init__()

    def draw(self, kind: str, path: Path | BinaryIO, grids: Iterable[Grid], dots: int = DOTS) -> None:
        """Draw the only grid of `grids` as a file of `kind` ``png``, ``svg``, ``pdf`` or ``html``.

        `path` may be an open file, except for ``html``. `dots` is the number of dots per inch of a ``png``.
        """
        from meshonet.formats.figure.page.page import write_page

        grid = only_one(grids, "a picture")
        if kind == "html" and self.of_row:
            name = "meridional" if self.meridional else "span"
            raise InputError(f"{{{name}}} is for pictures", "write .png, .svg or .pdf", parameter=name)
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


def write(
    path: Path | BinaryIO,
    grid: Grid,
    kind: str = "png",
    colouring: Colouring | None = None,
    view: View | None = None,
    dots: int = DOTS,
) -> None:
    """Draw `grid` as a file of `kind` ``png``, ``svg`` or ``pdf``; the same input gives the same bytes.

    Raises InputError if no cell is in the view, or if the view is three-dimensional and the grid is planar.
    """
    import matplotlib as mpl

    from meshonet.formats.figure.figure import draw
    from meshonet.formats.figure.space import draw_in_space

    view = view or View()
    low, high = grid.box
    check_extent(float((high - low).max()))
    dates: dict[str, dict[str, str | None]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with mpl.rc_context({"svg.hashsalt": "meshonet", "svg.fonttype": "none"}):
        if grid.form == "plane":
            check_flat(view)
            figure = draw(grid, colouring, flat_box(view.zoom), view.every)
        else:
            figure = draw_in_space(grid, colouring, view)
        figure.savefig(path, format=kind, dpi=dots, metadata=dates.get(kind))


def write_grids(path: Path, grids: Iterable[Grid], *, kind: str) -> None:
    """Write a picture, without colours, of a grid; `grids` has exactly one."""
    write(path, only_one(grids, f"a .{kind} file"), kind)
