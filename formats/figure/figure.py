"""Pictures of a grid: ``.png``, ``.svg``, ``.pdf``. Only this room imports matplotlib.

A picture has far fewer pixels than a fine grid has cells, so cells are coloured in blocks of about a
pixel, each with the worst value in it, and only every k-th grid line is drawn.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.figure.layers import INK, Box, Part, body, in_view, outline, paint, rule
from meshonet.formats.format import only_one
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DOTS = 160
"""Dots an inch of the picture."""
_NAME = 48
"""Letters of a grid's name that fit above a view."""


@dataclass(frozen=True)
class Colouring:
    """A value for each cell and how to show it.

    Parameters
    ----------
    values : (ni-1, nj-1) a value a cell.
    label : quantity and unit, for the colour bar.
    limits : values at the two ends of the colours; None takes the 1st and 99th percentile in view.
    worst_is_low : small values are the bad ones and keep the strong colours.
    """

    values: NDArray[Any]
    label: str
    limits: tuple[float, float] | None = None
    worst_is_low: bool = False


def draw(
    grid: Grid, colouring: Colouring | None = None, zoom: Box | None = None, every: int | None = None
) -> Figure:
    """Return a figure of `grid`; of a grid around a small body, one view near it and one of the whole.

    Parameters
    ----------
    grid : what to draw.
    colouring : values to colour the cells by; None draws lines only.
    zoom : x0, x1, y0, y1 of the part to show, in one view.
    every : K, to draw every K-th grid line; None chooses it.

    Raises InputError: a zoom that is empty or shows nothing, `every` below 1, values of the wrong shape.
    """
    _check(grid, colouring, zoom, every)
    views = [zoom] if zoom else _views(grid)
    parts = [_visible(grid, view) for view in views]
    figure, axes, bar = _frame([_ratio(view) for view in views], colouring is not None)
    mesh = None
    limits = _limits(colouring, parts[0]) if colouring else (0.0, 1.0)
    for ax, view, part in zip(axes, views, parts, strict=True):
        pixels = ax.get_window_extent().width / (view[1] - view[0])
        if colouring:
            low = colouring.worst_is_low
            mesh = paint(
                ax, grid, colouring.values, part, pixels, limits, "YlGnBu_r" if low else "YlGnBu", low=low
            )
        steps = rule(ax, grid, part, pixels, every, faint=colouring is not None)
        outline(ax, grid)
        ax.set(xlim=view[:2], ylim=view[2:])
        if max(steps) > 1:
            _note(ax, _drawn_lines(*steps))
    if bar is not None and mesh is not None and colouring:
        figure.colorbar(mesh, cax=bar, extend=_beyond(colouring, limits)).set_label(
            colouring.label, color=INK, size=9
        )
        bar.tick_params(labelsize=8, color=INK, labelcolor=INK)
    name = grid.name if len(grid.name) <= _NAME else grid.name[: _NAME - 1] + "…"
    title = f"{name}   {grid.ni} × {grid.nj} nodes".strip()
    axes[0].set_title(title, size=10, color=INK, loc="left", pad=4)
    return figure


def write(
    path: Path,
    grid: Grid,
    kind: str = "png",
    colouring: Colouring | None = None,
    zoom: Box | None = None,
    every: int | None = None,
) -> None:
    """Draw `grid` into a file of `kind` ``png``, ``svg`` or ``pdf``; the same input gives the same bytes."""
    import matplotlib as mpl

    dates: dict[str, dict[str, str | None]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with mpl.rc_context({"svg.hashsalt": "meshonet", "svg.fonttype": "none"}):
        figure = draw(grid, colouring, zoom, every)
        figure.savefig(path, format=kind, dpi=_DOTS, metadata=dates.get(kind))


def write_grids(path: Path, grids: Iterable[Grid], *, kind: str) -> None:
    """Draw the one grid of `grids`, lines only."""
    write(path, only_one(grids, f"a .{kind} file"), kind)


def _check(grid: Grid, colouring: Colouring | None, zoom: Box | None, every: int | None) -> None:
    if colouring is not None and colouring.values.shape != (grid.ni - 1, grid.nj - 1):
        raise InputError(
            f"cell values have shape {colouring.values.shape}", f"give ({grid.ni - 1}, {grid.nj - 1})"
        )
    if every is not None and every < 1:
        raise InputError(f"every {every}-th line cannot be drawn", "use 1 or more")
    if zoom is not None and not (np.isfinite(zoom).all() and zoom[0] < zoom[1] and zoom[2] < zoom[3]):
        raise InputError(f"zoom {zoom} is empty", "give x0,x1,y0,y1 with x0 < x1 and y0 < y1")


def _visible(grid: Grid, view: Box) -> Part:
    part = in_view(grid, view)
    if part is None:
        spans = "x {:.4g} to {:.4g}, y {:.4g} to {:.4g}".format(*_whole(grid))
        raise InputError(f"zoom {view} shows none of the grid", f"the grid spans {spans}")
    return part


def _views(grid: Grid) -> list[Box]:
    """Return what to show: the whole, and before it the surroundings of a body that is small in it."""
    whole = _whole(grid)
    pad = 0.02 * max(whole[1] - whole[0], whole[3] - whole[2])
    whole = (whole[0] - pad, whole[1] + pad, whole[2] - pad, whole[3] + pad)
    if not grid.around_body:
        return [whole]
    wall = body(grid)
    low, high = wall.min(axis=0), wall.max(axis=0)
    size, (x, y) = float((high - low).max()), ((low + high) / 2).tolist()
    if size <= 0 or whole[1] - whole[0] < 5 * size:
        return [whole]
    wide, tall = 0.68 * size, 0.51 * size
    return [(x - wide, x + wide, y - tall, y + tall), whole]


def _whole(grid: Grid) -> Box:
    return float(grid.x.min()), float(grid.x.max()), float(grid.y.min()), float(grid.y.max())


def _ratio(box: Box) -> float:
    return min(max((box[1] - box[0]) / (box[3] - box[2]), 0.02), 50.0)


def _limits(colouring: Colouring, part: Part) -> tuple[float, float]:
    if colouring.limits:
        return colouring.limits
    values = colouring.values[part.i0 : part.i1, part.j0 : part.j1][part.mask]
    low, high = (
        np.percentile(values[np.isfinite(values)], (1, 99)) if np.isfinite(values).any() else (0.0, 1.0)
    )
    return float(low), float(max(high, low + 1e-9 * abs(low) + 1e-30))


def _beyond(colouring: Colouring, limits: tuple[float, float]) -> str:
    """Return at which ends of the colour bar values lie beyond it, as matplotlib says it."""
    below, above = bool((colouring.values < limits[0]).any()), bool((colouring.values > limits[1]).any())
    return {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[
        below, above
    ]


def _frame(ratios: list[float], bar: bool) -> tuple[Figure, list[Axes], Axes | None]:
    """Return a figure with one axes a view, equally high side by side, and one for the colour bar."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    left, right, low, top, gap = 0.5, 0.15, 0.35, 0.32, 0.5
    side = 0.95 if bar else 0.0
    room = 11.0 - left - right - side - gap * (len(ratios) - 1)
    height = min(max(room / sum(ratios), 1.6), 6.2)
    width = left + height * sum(ratios) + gap * (len(ratios) - 1) + side + right
    total = low + height + top
    figure = Figure(figsize=(width, total), facecolor="white", dpi=_DOTS)
    FigureCanvasAgg(figure)
    axes, at = [], left
    for ratio in ratios:
        ax = figure.add_axes((at / width, low / total, height * ratio / width, height / total))
        ax.tick_params(labelsize=8, color=INK, labelcolor=INK, length=2.5, width=0.6)
        for spine in ax.spines.values():
            spine.set(linewidth=0.6, color=INK)
        axes.append(ax)
        at += height * ratio + gap
    if not bar:
        return figure, axes, None
    place = ((at - gap + 0.15) / width, low / total, 0.14 / width, height / total)
    return figure, axes, figure.add_axes(place)


def _note(ax: Axes, text: str) -> None:
    paper = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 2.0}
    ax.text(
        0.985,
        0.015,
        text,
        transform=ax.transAxes,
        ha="right",
        va="bottom",
        size=7,
        color=INK,
        bbox=paper,
        zorder=5,
    )


def _drawn_lines(xi: int, eta: int) -> str:
    """Return in words which lines are drawn: every `xi`-th and every `eta`-th, one of them above 1."""
    if xi == eta:
        return f"every {_ordinal(xi)}line"
    return f"every {_ordinal(xi)}xi and {_ordinal(eta)}eta line"


def _ordinal(k: int) -> str:
    """Return ``3rd `` and the like; nothing for 1."""
    if k == 1:
        return ""
    last = k % 10 if k % 100 not in (11, 12, 13) else 0
    return f"{k}{('th', 'st', 'nd', 'rd')[last] if last < 4 else 'th'} "
