"""Elements of a picture of a planar grid: coloured cells, grid lines and outlines; and the cells in view."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Bools, Floats, cross2
from meshonet.geometry.blocks.grid import Grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh

Box = tuple[float, float, float, float]  # x0, x1, y0, y1 in the unit of the grid
DOTS = 160  # dots per inch of a picture
INK = "#1b2733"
_BODY = "#e8eaed"
_LINE_GAP = 6.0  # smallest distance in pixels between drawn grid lines, in the middle of the cells
_BLOCK = 1.0  # smallest size in pixels of a coloured group of cells
_SAMPLE = 200_000  # number of cells that are examined to select the step between drawn lines


@dataclass(frozen=True)
class Colouring:
    """Cell values and the colours that represent them.

    Parameters
    ----------
    values : cell values (ni-1, nj-1); for several blocks, a tuple with an array for each block.
    label : text at the colour scale: quantity and unit.
    limits : values at the ends of the colour scale; None: 1st and 99th percentile of the visible cells.
    worst_is_low : whether small values are bad; bad values get strong colours.
    """

    values: NDArray[Any] | tuple[NDArray[Any], ...]
    label: str
    limits: tuple[float, float] | None = None
    worst_is_low: bool = False

    @property
    def parts(self) -> tuple[NDArray[Any], ...]:
        """Values as a tuple with one array for each block."""
        return self.values if isinstance(self.values, tuple) else (self.values,)

    @property
    def scale(self) -> str:
        """Name of the matplotlib colour map."""
        return "YlGnBu_r" if self.worst_is_low else "YlGnBu"

    @property
    def worst(self) -> np.ufunc:
        """Function that reduces the values of several cells to the worst of them."""
        return np.minimum if self.worst_is_low else np.maximum


_EVEN = 5e-3  # smallest half width of the colour scale relative to its middle, so that labels differ


def limits_of(colouring: Colouring | None, shown: Sequence[NDArray[Any]]) -> tuple[float, float]:
    """Return the values at the ends of the colour scale, given the values `shown` of the visible cells."""
    if colouring is None:
        return 0.0, 1.0
    if colouring.limits:
        return colouring.limits
    values = np.concatenate([np.empty(0), *map(np.ravel, shown)])
    finite = values[np.isfinite(values)]
    low, high = np.percentile(finite, (1, 99)) if finite.size else (0.0, 1.0)
    middle, half = 0.5 * float(low + high), 0.5 * float(high - low)
    if half < _EVEN * abs(middle) or not half:
        half = _EVEN * abs(middle) or 1.0
        return middle - half, middle + half
    return float(low), float(high)


def padded(points: Floats, part: float) -> Box:
    """Return the bounding box of points (n, 2), enlarged on each side by `part` times its longer side."""
    low, high = points.min(axis=0), points.max(axis=0)
    pad = part * float((high - low).max())
    return float(low[0] - pad), float(high[0] + pad), float(low[1] - pad), float(high[1] + pad)


class CellsInView(NamedTuple):
    """Visible cells: a `mask` (i1-i0, j1-j0) of the cells with indices i0 to i1-1 and j0 to j1-1."""

    i0: int
    i1: int
    j0: int
    j1: int
    mask: Bools


def in_view(grid: Grid, box: Box) -> CellsInView | None:
    """Return the cells whose bounding boxes intersect `box`; None if there are none."""
    meets = _meets(grid.x, box[0], box[1]) & _meets(grid.y, box[2], box[3])
    columns, rows = np.flatnonzero(meets.any(axis=1)), np.flatnonzero(meets.any(axis=0))
    if not len(columns):
        return None
    i0, i1, j0, j1 = int(columns[0]), int(columns[-1]) + 1, int(rows[0]), int(rows[-1]) + 1
    return CellsInView(i0, i1, j0, j1, meets[i0:i1, j0:j1])


def paint(
    ax: Axes,
    grid: Grid,
    values: NDArray[Any],
    part: CellsInView,
    pixels: float,
    limits: tuple[float, float],
    colouring: Colouring,
) -> QuadMesh:
    """Colour the cells `part` by `values` (ni-1, nj-1); a pixel with several cells shows the worst."""
    nodes = grid.nodes[part.i0 : part.i1 + 1, part.j0 : part.j1 + 1]
    shown = values[part.i0 : part.i1, part.j0 : part.j1]
    columns = _blocks(_extents(nodes, part.mask, 0) * pixels)
    rows = _blocks(_extents(nodes, part.mask, 1) * pixels)
    shown = reduced(colouring.worst, shown, columns, rows)
    shown = np.ma.masked_array(shown, ~reduced(np.logical_or, part.mask, columns, rows))
    corners = nodes[np.ix_(columns, rows)]
    scale: dict[str, Any] = {"cmap": colouring.scale, "vmin": limits[0], "vmax": limits[1]}
    return ax.pcolormesh(corners[..., 0], corners[..., 1], shown, rasterized=True, zorder=1, **scale)


def rule(
    ax: Axes,
    grid: Grid,
    part: CellsInView,
    steps: tuple[int, int],
    *,
    faint: bool,
    flipped: tuple[bool, bool] = (False, False),
) -> None:
    """Draw every n-th grid line of the cells `part`, and the last line.

    `steps` has n for lines i = const and for lines j = const. If `flipped`, lines are counted backwards.
    """
    from matplotlib.collections import LineCollection

    columns = _every(part.i0, part.i1, steps[0], grid.ni, flipped=flipped[0])
    rows = _every(part.j0, part.j1, steps[1], grid.nj, flipped=flipped[1])
    along_j = [grid.nodes[i, part.j0 : part.j1 + 1] for i in columns]
    along_i = [grid.nodes[part.i0 : part.i1 + 1, j] for j in rows]
    width, alpha = (0.35, 0.45) if faint else (0.45, 0.8)
    lines = LineCollection(along_j + along_i, colors=INK, linewidths=width, alpha=alpha, zorder=2)
    ax.add_collection(lines)


def outline(ax: Axes, grid: Grid) -> None:
    """Draw the outer edges with thicker lines; in an O or C grid, fill the body."""
    ends = () if grid.periodic else (grid.nodes[0], grid.nodes[-1])
    for edge in (grid.nodes[:, 0], grid.nodes[:, -1], *ends):
        ax.plot(edge[:, 0], edge[:, 1], color=INK, linewidth=0.9, zorder=4)
    if grid.around_body:
        wall = body(grid)
        ax.fill(wall[:, 0], wall[:, 1], facecolor=_BODY, edgecolor=INK, linewidth=0.9, zorder=3)


def body(grid: Grid) -> Floats:
    """Return the nodes (n, 2) of the south patch ``wall``; if there is none, of the whole south side."""
    for part in grid.patches:
        if part.side == "south" and part.name == "wall":
            return grid.nodes[part.start : part.stop + 1, 0]
    return grid.nodes[:, 0]


def reduced(
    by: np.ufunc, values: NDArray[Any], columns: NDArray[np.intp], rows: NDArray[np.intp]
) -> NDArray[Any]:
    """Return cell values, merged by `by` in rectangles between successive grid lines `columns` and `rows`."""
    joined: NDArray[Any] = by.reduceat(by.reduceat(values, columns[:-1], axis=0), rows[:-1], axis=1)
    return joined


def _meets(coordinate: Floats, low: float, high: float) -> Bools:
    """Return for each cell (ni-1, nj-1) whether one coordinate (ni, nj) has values in [low, high]."""
    least = np.minimum(coordinate[1:], coordinate[:-1])
    most = np.maximum(coordinate[1:], coordinate[:-1])
    inside = np.minimum(least[:, 1:], least[:, :-1]) <= high
    inside &= np.maximum(most[:, 1:], most[:, :-1]) >= low
    return inside


def _extents(nodes: Floats, mask: Bools, axis: int) -> Floats:
    """Return the longest edge in view of each layer of cells along `axis`, in the unit of the grid."""
    step = np.diff(nodes, axis=axis)
    length = np.hypot(step[..., 0], step[..., 1])
    edge = length[:, :-1] if axis == 0 else length[:-1]
    largest: Floats = np.where(mask, edge, 0.0).max(axis=1 - axis)
    return largest


def _blocks(sizes: Floats) -> NDArray[np.intp]:
    """Return node indices, including both ends, that divide `sizes` (n,) into groups of about a pixel."""
    marks = np.floor(np.concatenate([[0.0], np.cumsum(np.minimum(sizes, _BLOCK))]) / _BLOCK)
    # size 0 is out of view, and never in a block with others, whose corners it would drag away
    new = (np.diff(marks[:-1]) > 0) | np.diff(sizes > 0)
    return np.concatenate([[0], np.flatnonzero(new) + 1, [len(sizes)]])


def line_gaps(grid: Grid, part: CellsInView) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
    """Return two pairs (distances between grid lines, cell areas), all (n,), at n visible cells of `part`.

    The first pair is for lines of constant i, the second for lines of constant j. The areas are the same.
    """
    i, j = np.nonzero(part.mask)
    stride = max(1, len(i) // _SAMPLE)
    i, j = i[::stride] + part.i0, j[::stride] + part.j0
    corner = grid.nodes[i, j]
    along, across = grid.nodes[i + 1, j] - corner, grid.nodes[i, j + 1] - corner
    area = np.abs(cross2(along, across))
    return (np.hypot(along[:, 0], along[:, 1]), area), (np.hypot(across[:, 0], across[:, 1]), area)


def line_step(length: Floats, area: Floats, pixels: float) -> int:
    """Return k = 1, 2, 5, 10, ... such that every k-th line is drawn, usually 6 pixels or more apart.

    `length` (n,) are distances between lines, `area` (n,) areas of cells, `pixels` pixels per unit of length.
    """
    length = length * pixels
    order = np.argsort(length)
    weight = np.cumsum(area[order])
    typical = length[order[min(int(np.searchsorted(weight, weight[-1] / 2)), len(order) - 1)]]
    step = _LINE_GAP / typical if typical > 0 else 1.0
    if step <= 1.0:
        return 1
    power = 10.0 ** np.floor(np.log10(step))
    return int(next(m * power for m in (1, 2, 5, 10) if m * power >= step * 0.999))


def _every(start: int, stop: int, step: int, count: int, *, flipped: bool = False) -> list[int]:
    """Return the multiples of `step` from `start` to `stop`, and the last line if it is in view."""
    if flipped:
        last = count - 1
        return [last - k for k in _every(last - stop, last - start, step, count)]
    first = -(-start // step) * step
    lines = list(range(first, stop + 1, step))
    return [*lines, count - 1] if stop == count - 1 and count - 1 not in lines else lines
