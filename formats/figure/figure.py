"""Pictures of planar grids; only `formats.figure` imports matplotlib.

Cells are coloured in groups of about a pixel, each by its worst value; only every k-th line is drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.figure.blocks import lines_of_blocks, mark_vertices, outline_blocks, shown_counts
from meshonet.formats.figure.layers import (
    DOTS,
    INK,
    Box,
    CellsInView,
    Colouring,
    body,
    in_view,
    limits_of,
    outline,
    padded,
    paint,
    rule,
)
from meshonet.formats.figure.view import nothing_in
from meshonet.geometry.blocks.across import planar
from meshonet.geometry.blocks.grid import Grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

_NAME = 48  # number of letters of a grid's name that fit above a view


def draw(
    grid: Grid, colouring: Colouring | None = None, zoom: Box | None = None, every: int | None = None
) -> Figure:
    """Return a figure of a planar grid; without `colouring`, it shows grid lines only.

    Only the box `zoom` is drawn; without it, a grid around a small body gets a second view near the body.
    Each `every`-th line is drawn; None selects the step. Raises InputError if no cell is inside `zoom`.
    """
    if grid.topology == "blocks":
        planar(grid)
    singles = [Grid((block,)) for block in grid.blocks] if grid.topology == "blocks" else [grid]
    views = [zoom] if zoom else _views(grid)
    parts = [_visible(grid, singles, view) for view in views]
    figure, axes, bar = frame(views, colouring is not None)
    mesh = None
    # near a body one block has the colours of what matters there; many blocks have those of the whole
    ruling = parts[-1] if grid.topology == "blocks" else parts[0]
    limits = limits_of(colouring, _shown(colouring, ruling))
    for ax, view, seen in zip(axes, views, parts, strict=True):
        pixels = ax.get_window_extent().width / (view[1] - view[0])
        lines = lines_of_blocks(grid, singles, seen, pixels, every)
        for k, (single, part, (step, flipped)) in enumerate(zip(singles, seen, lines, strict=True)):
            if not part:
                continue
            if colouring:
                mesh = paint(ax, single, colouring.parts[k], part, pixels, limits, colouring)
            rule(ax, single, part, step, faint=colouring is not None, flipped=flipped)
        if grid.topology == "blocks":
            outline_blocks(ax, grid)
            mark_vertices(ax, grid)
        else:
            outline(ax, grid)
        ax.set(xlim=view[:2], ylim=view[2:])
        steps = [pair for pair, _ in lines]
        each = sorted({step for pair in steps for step in pair})
        note(ax, _drawn_lines(*steps[0]) if len(steps) == 1 and len(each) > 1 else step_words(each))
    if bar is not None and mesh is not None and colouring:
        below = any(bool((values < limits[0]).any()) for values in colouring.parts)
        above = any(bool((values > limits[1]).any()) for values in colouring.parts)
        ends = ("neither", "min", "max", "both")[below + 2 * above]  # in matplotlib's words
        colour_bar(bar, mesh, colouring.label, ends)
    name = grid.name if len(grid.name) <= _NAME else grid.name[: _NAME - 1] + "…"
    size = shown_counts(grid) if grid.topology == "blocks" else f"{grid.ni} × {grid.nj} nodes"
    title = f"{name}   {size}".strip()
    axes[0].set_title(title, size=10, color=INK, loc="left", pad=4)
    return figure


def _visible(grid: Grid, singles: list[Grid], view: Box) -> list[CellsInView | None]:
    parts = [in_view(single, view) for single in singles]
    if not any(parts):
        raise nothing_in(view, *grid.box)
    return parts


def _views(grid: Grid) -> list[Box]:
    """Return the boxes to show: the surroundings of a small body, if any, and the whole grid."""
    whole = padded(np.array(grid.box), 0.02)
    if grid.topology == "blocks":
        wall = np.concatenate([np.empty((0, 2)), *map(grid.at, grid.walls())])
    else:
        wall = body(grid) if grid.around_body else np.empty((0, 2))
    if not len(wall):
        return [whole]
    low, high = wall.min(axis=0), wall.max(axis=0)
    size, (x, y) = float((high - low).max()), ((low + high) / 2).tolist()
    if size <= 0 or whole[1] - whole[0] < 5 * size:
        return [whole]
    wide, tall = 0.68 * size, 0.51 * size
    return [(x - wide, x + wide, y - tall, y + tall), whole]


def _shown(colouring: Colouring | None, parts: list[CellsInView | None]) -> list[NDArray[Any]]:
    if colouring is None:
        return []
    return [
        values[part.i0 : part.i1, part.j0 : part.j1][part.mask]
        for values, part in zip(colouring.parts, parts, strict=True)
        if part
    ]


def colour_bar(bar: Axes, colours: ScalarMappable, label: str, extend: str = "neither") -> None:
    """Draw the colour scale into the axes `bar`."""
    bar.figure.colorbar(colours, cax=bar, extend=extend).set_label(label, color=INK, size=9)
    bar.ticklabel_format(axis="y", useOffset=False)
    bar.tick_params(labelsize=8, color=INK, labelcolor=INK)


def frame(views: Sequence[Box], bar: bool) -> tuple[Figure, list[Axes], Axes | None]:
    """Return a figure, equally high axes for each view and, if `bar`, axes for the colour scale."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    ratios = [min(max((box[1] - box[0]) / (box[3] - box[2]), 0.02), 50.0) for box in views]
    left, right, low, top, gap = 0.5, 0.15, 0.35, 0.32, 0.5
    side = 0.95 if bar else 0.0
    room = 11.0 - left - right - side - gap * (len(ratios) - 1)
    height = min(max(room / sum(ratios), 1.6), 6.2)
    width = left + height * sum(ratios) + gap * (len(ratios) - 1) + side + right
    total = low + height + top
    figure = Figure(figsize=(width, total), facecolor="white", dpi=DOTS)
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


def step_words(steps: list[int]) -> str:
    """Return a note on grid lines left out, or "".

    In each direction of each block, every k-th line is drawn; `steps` are the different k, ascending.

    >>> step_words([1, 5]), step_words([2]), step_words([1])
    ('not all lines are drawn', 'every 2nd line', '')
    """
    if steps[-1] == 1:
        return ""
    return f"every {_ordinal(steps[0])}line" if len(steps) == 1 else "not all lines are drawn"


def note(ax: Axes, text: str) -> None:
    """Write `text` into the lower right corner; an empty text writes nothing."""
    if not text:
        return
    paper = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 2.0}
    place: dict[str, Any] = {"transform": ax.transAxes, "ha": "right", "va": "bottom", "zorder": 5}
    ax.text(0.985, 0.015, text, size=7, color=INK, bbox=paper, **place)


def _drawn_lines(xi: int, eta: int) -> str:
    return f"every {_ordinal(xi)}xi and {_ordinal(eta)}eta line"


def _ordinal(k: int) -> str:
    """Return an ordinal such as ``3rd `` with a space; empty for 1."""
    if k == 1:
        return ""
    last = k % 10 if k % 100 not in (11, 12, 13) else 0
    return f"{k}{('th', 'st', 'nd', 'rd')[last] if last < 4 else 'th'} "
