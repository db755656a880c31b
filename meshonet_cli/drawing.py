"""Pictures of grids and files of their metrics, for `plot` and `quality`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from meshonet.formats.format import only_one
from meshonet.formats.registry import format_for_output
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import folded_cells, per_cell
from meshonet.geometry.quality.metrics import METRICS, NAMES
from meshonet_cli.batch.destination import Destination

PICTURES = ("png", "svg", "pdf")


@dataclass(frozen=True)
class Picture:
    """How a grid is drawn.

    Parameters
    ----------
    metric : colours the cells; None draws lines only.
    zoom : x0, x1, y0, y1 of the part to show; None shows all.
    every : draw every so many-th grid line; None chooses.
    """

    metric: str | None = "max_angle"
    zoom: tuple[float, float, float, float] | None = None
    every: int | None = None

    def draw(self, kind: str, path: Path, grids: Iterable[Grid]) -> None:
        """Draw the one grid of `grids` to `path`, as ``png``, ``svg`` or ``pdf``."""
        from meshonet.formats.figure.figure import Colouring, write

        grid = only_one(grids, "a picture")
        colouring = None
        for metric in METRICS:
            if metric.name == self.metric:
                label = f"{metric.name} ({metric.unit})" if metric.unit else metric.name
                values = per_cell(grid, metric.name)
                colouring = Colouring(values, label, worst_is_low=metric.worst == "min")
        write(path, grid, kind, colouring, self.zoom, self.every)


def picture_file(output: str, to_format: str | None, picture: Picture) -> Destination:
    """Return the destination of `picture`.

    Raises
    ------
    InputError
        `output` is no picture.
    """
    to_format = to_format or ("png" if output == "-" else None)
    found = format_for_output(output, to_format)
    if found.name not in PICTURES:
        raise InputError(f"{found.name} is no picture", "use .png, .svg or .pdf", source=output)
    return Destination(output, to_format, put=partial(picture.draw, found.name))


def metrics_file(output: str) -> Destination:
    """Return the destination of a grid with every metric as cell data.

    Raises
    ------
    InputError
        `output` is no ``.vts``, which is what can hold cell data.
    """
    if format_for_output(output).name != "vts":
        raise InputError("only a .vts file holds metrics", "name it FILE.vts", source=output)
    return Destination(output, None, put=_write_metrics)


def metric_named(text: str) -> str | None:
    """Return the metric of ``--metric``, None for ``none``.

    Raises
    ------
    InputError
        there is no such metric.
    """
    if text not in (*NAMES, "none"):
        known = "use none or one of " + ", ".join(NAMES)
        raise InputError(f"metric {text!r} is not known", known, source="--metric")
    return None if text == "none" else text


def zoom_box(text: str | None) -> tuple[float, float, float, float] | None:
    """Return the box ``x0,x1,y0,y1``, or None for None.

    Raises
    ------
    InputError
        `text` is not four numbers with x0 < x1 and y0 < y1.

    Examples
    --------
    >>> zoom_box("-0.1,1.1,-0.5,0.5")
    (-0.1, 1.1, -0.5, 0.5)
    """
    if text is None:
        return None
    try:
        x0, x1, y0, y1 = (float(word) for word in text.split(","))
    except ValueError:
        x0 = x1 = y0 = y1 = 0.0
    if not (x0 < x1 and y0 < y1):
        raise InputError(
            f"{text!r} is not a box",
            "use x0,x1,y0,y1 with x0 < x1 and y0 < y1, e.g. 0.9,1.1,-0.1,0.1",
            source="--zoom",
        )
    return x0, x1, y0, y1


def _write_metrics(path: Path, grids: Iterable[Grid]) -> None:
    import numpy as np

    from meshonet.formats.vtk.vts import write

    grid = only_one(grids, "a .vts file")
    cells = {name: per_cell(grid, name) for name in NAMES}
    folded = np.zeros((grid.ni - 1, grid.nj - 1), dtype=np.int8)
    folded[tuple(folded_cells(grid.nodes).T)] = 1
    write(path, grid, {**cells, "folded": folded})
