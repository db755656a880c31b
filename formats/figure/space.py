"""Pictures of volumes and surfaces in parallel projection, painted from back to front.

Groups of cells of a few pixels have their worst value; plane grid surfaces are drawn like planar grids.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from meshonet.formats.figure.blocks import shown_counts
from meshonet.formats.figure.figure import colour_bar, draw, frame, note, step_words
from meshonet.formats.figure.layers import INK, Box, Colouring, limits_of, padded
from meshonet.formats.figure.painting import faint_ink, paint, painted, steps_of
from meshonet.formats.figure.row_sections import RowSections
from meshonet.formats.figure.slices import CellSheet, Cut, cut, layers
from meshonet.formats.figure.view import View, flat_box, nothing_in
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import PLACES, Block, face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_FLAT = 1e-9  # largest extent of a plane grid surface along its normal, relative to its size


def draw_in_space(grid: Grid, colouring: Colouring | None, view: View) -> Figure:
    """Return a figure of a volume or a surface; `colouring` has the cell values to show.

    Raises InputError: a slice that the grid lacks; a zoom box that contains no cells; a zoom box of four
    coordinates for a picture that needs six, or the reverse.
    """
    values = [np.asarray(part) for part in colouring.parts] if colouring else None
    where = view.part
    if view.of_row:
        return _row_figure(grid, values, colouring, view)
    if where is None:
        return _seen(grid, _surface(grid, values), colouring, view)
    if grid.form != "volume":
        raise InputError("a surface has no slices", "slice volumes", parameter="slice")
    if where.index is None:
        box = flat_box(view.zoom, where.direction)
        names = [name for k, name in enumerate("xyz") if k != where.direction]
        titled = replace(grid, name=f"{grid.name}   {where}".strip())
        return _sections_figure(titled, [cut(grid, where, values)], names, colouring, box, [""])
    sheets = layers(grid, where, values)
    flat, across = _flattened(sheets)
    if flat is None:
        return _seen(grid, sheets, colouring, view)
    blocks = tuple(Block(nodes) for nodes in flat)
    plane = Grid(blocks, name=f"{grid.name}   {where}".strip())
    if colouring:
        shown = tuple(sheet.values for sheet in sheets if sheet.values is not None)
        colouring = replace(colouring, values=shown)
    return draw(plane, colouring, flat_box(view.zoom, across), view.every)


def _surface(grid: Grid, values: list[Floats] | None) -> list[CellSheet]:
    """Return the patches of a surface, or the walls of a volume, else its whole boundary."""
    if grid.form == "surface":
        return [CellSheet(block.nodes, values[k] if values else None) for k, block in enumerate(grid.blocks)]
    sheets, walls = [], grid.walls()
    for patch in walls or grid.outer_patches():
        spans = patch.range(grid.face(patch.block, patch.side).shape[:-1])
        cells = face_of(values[patch.block], patch.side) if values else None
        shown = None if cells is None else cells[tuple(slice(*span) for span in spans)]
        axis, end = PLACES[patch.side]
        inwards = (1, -1, 1)[axis] * (1 if end == 0 else -1)  # of a right-handed block
        sheets.append(CellSheet(grid.at(patch), shown, inwards if walls else 0))
    return sheets


def _flattened(sheets: Sequence[CellSheet]) -> tuple[list[Floats] | None, int]:
    """Return nodes (n, m, 2) of sheets in a plane normal to an axis, else None; and the axis."""
    every = np.concatenate([sheet.nodes.reshape(-1, 3) for sheet in sheets])
    extent = np.ptp(every, axis=0)
    across = int(extent.argmin())
    if extent[across] > _FLAT * extent.max():
        return None, across
    return [np.delete(sheet.nodes, across, axis=2) for sheet in sheets], across


def _seen(grid: Grid, sheets: Sequence[CellSheet], colouring: Colouring | None, view: View) -> Figure:
    axes = view.axes
    inside = [_within(sheet, view.zoom) for sheet in sheets]
    shown = [
        nodes[mask]
        for sheet, mask in zip(sheets, inside, strict=True)
        for nodes in (sheet.nodes[:-1, :-1], sheet.nodes[1:, :-1], sheet.nodes[:-1, 1:], sheet.nodes[1:, 1:])
    ]
    points = np.concatenate(shown) @ axes[:2].T
    if not len(points):
        every = np.concatenate([sheet.nodes.reshape(-1, 3) for sheet in sheets])
        raise nothing_in(view.zoom or (), every.min(axis=0), every.max(axis=0))
    box = padded(points, 0.03)
    figure, (ax,), bar = frame([box], colouring is not None)
    pixels = ax.get_window_extent().width / (box[1] - box[0])
    steps = [steps_of(sheet, axes, pixels, view.every) for sheet in sheets]
    limits = limits_of(colouring, [sheet.values for sheet in sheets if sheet.values is not None])
    parts = [
        painted(sheet, mask, step, axes, colouring, limits)
        for sheet, mask, step in zip(sheets, inside, steps, strict=True)
    ]
    paint(ax, parts)
    ax.set(xlim=box[:2], ylim=box[2:])
    ax.set_axis_off()
    _triad(ax, axes, _emptiest(points, box))
    note(ax, step_words(sorted({step for pair in steps for step in pair})))
    _finish(ax, bar, grid, colouring, limits)
    return figure


def _within(sheet: CellSheet, zoom: tuple[float, ...] | None) -> Any:
    """Return for each cell (n-1, m-1) whether it is in the box `zoom`."""
    shape = [count - 1 for count in sheet.nodes.shape[:2]]
    if zoom is None:
        return np.ones(shape, dtype=bool)
    if len(zoom) != 6:
        remedy = "use x0,x1,y0,y1,z0,z1, or a flat slice"
        raise InputError("a picture in space is zoomed by a box in space", remedy, parameter="zoom")
    centre = 0.25 * (
        sheet.nodes[:-1, :-1] + sheet.nodes[1:, :-1] + sheet.nodes[:-1, 1:] + sheet.nodes[1:, 1:]
    )
    low, high = np.array(zoom[::2]), np.array(zoom[1::2])
    return ((centre >= low) & (centre <= high)).all(axis=-1)


def _row_figure(grid: Grid, values: list[Any] | None, colouring: Colouring | None, view: View) -> Figure:
    """Return a picture of sections of a blade row."""
    sections, zoom = RowSections(grid), flat_box(view.zoom)
    if view.meridional:
        title = f"{grid.name}   meridional".strip()
        cuts, names, labels = [sections.meridional(values)], [sections.axis_name, "r"], [""]
    else:
        title = f"{grid.name}   span {', '.join(f'{span:g}' for span in view.span)}".strip()
        cuts, names = (
            [sections.at(span, values) for span in view.span],
            ["length along the meridian", "r theta"],
        )
        labels = [f"span {span:g}" if len(view.span) > 1 else "" for span in view.span]
    return _sections_figure(replace(grid, name=title), cuts, names, colouring, zoom, labels)


def _sections_figure(
    grid: Grid, cuts: Sequence[Cut], names: Sequence[str], colouring: Colouring | None, zoom: Box | None,
    labels: Sequence[str],
) -> Figure:  # fmt: skip
    """Return a picture of the polygons of sections beside each other."""
    boxes = [zoom or padded(each.polygons.reshape(-1, 2), 0.02) for each in cuts]
    figure, axes, bar = frame(boxes, colouring is not None)
    limits = limits_of(colouring, [each.values for each in cuts if each.values is not None])
    for ax, box, each, label in zip(axes, boxes, cuts, labels, strict=True):
        _draw_polygons(ax, box, each, colouring, limits)
        ax.set(xlim=box[:2], ylim=box[2:])
        directions = f"{names[0]} to the right, {names[1]} upwards"
        note(ax, f"{label}   {names[0]}, {names[1]}" if label and ax is axes[0] else label or directions)
    _finish(axes[0], bar, grid, colouring, limits)
    return figure


def _draw_polygons(
    ax: Axes, box: Box, cut: Cut, colouring: Colouring | None, limits: tuple[float, float]
) -> None:
    """Draw polygons, with lines that are fainter where these are small."""
    from matplotlib.collections import PolyCollection

    pixels = ax.get_window_extent().width / (box[1] - box[0])
    x, y = np.moveaxis(cut.polygons, -1, 0)
    areas = 0.5 * np.abs((x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1))
    size = np.sqrt(areas) * pixels
    fills: dict[str, Any] = {"facecolors": "#e1e6eb"}
    if colouring and cut.values is not None:
        fills = {"array": cut.values, "cmap": colouring.scale, "clim": limits}
    widths = np.clip(0.06 * size, 0.0, 0.4)
    collection = PolyCollection(
        list(cut.polygons), edgecolors=faint_ink(0.6), linewidths=widths, rasterized=True, zorder=1, **fills
    )
    ax.add_collection(collection)


def _finish(
    ax: Axes, bar: Axes | None, grid: Grid, colouring: Colouring | None, limits: tuple[float, float]
) -> None:
    """Add title and colour scale."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    if bar is not None and colouring:
        colour_bar(bar, ScalarMappable(Normalize(*limits), colouring.scale), colouring.label)
    ax.set_title(f"{grid.name[:48]}   {shown_counts(grid)}".strip(), size=10, color=INK, loc="left", pad=4)


def _emptiest(points: Floats, box: Box) -> tuple[float, float]:
    """Return the corner of the picture with the fewest `points` (n, 2), but not the lower right one."""
    part = np.stack([(points[:, k] - box[2 * k]) / (box[2 * k + 1] - box[2 * k]) for k in (0, 1)], axis=1)
    corners = (0.0, 0.0), (0.0, 1.0), (1.0, 1.0)
    return min(corners, key=lambda corner: int((np.abs(part - corner) < 0.2).all(axis=1).sum()))


def _triad(ax: Axes, axes: Floats, corner: tuple[float, float]) -> None:
    """Draw the directions of x, y and z in a corner of the picture."""
    extent = ax.get_window_extent()
    x, y = (abs(55 - part * size) for part, size in zip(corner, (extent.width, extent.height), strict=True))
    place: dict[str, Any] = {"xycoords": "axes pixels", "textcoords": "axes pixels"}
    for k, name in enumerate("xyz"):
        right, up = axes[0, k], axes[1, k]
        tip = x + 38 * right, y + 38 * up
        arrow = {"arrowstyle": "-", "color": INK, "linewidth": 0.8}
        ax.annotate("", tip, (x, y), arrowprops=arrow, **place)
        at = x + 50 * right, y + 50 * up
        ax.annotate(name, tip, at, ha="center", va="center", size=8, color=INK, **place)
