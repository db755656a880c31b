"""Starting points of the columns of layers on a wall, dense at corners and where the wall turns."""

import math
from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, distinct
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.wall_turning import wall_bend
from meshonet.geometry.spacing.gradual_sizes import graded

TURN = np.radians(4.0)  # largest angle by which the wall turns along one cell
GROWTH = 0.1  # largest difference of neighbouring cells relative to their length
_SAMPLES = 4000  # points around a loop at which sizes are tabulated: 28 in each of the longest cells
_CORNER_PART = 1.0 / 40.0  # length of a cell at a corner over the largest one
_PIECE_PART = 1.0 / 3.0  # largest length of a cell at a corner over that of the shorter wall there
_RESOLVED = 0.01  # smallest length of a cell at a corner over the distance of samples


def wall_columns(loop: Loop, largest: float, sums: Sequence[float] = ()) -> Floats:
    """Return the ascending arc lengths (n,) at which columns of layers start; each corner has a column.

    `largest` is the greatest distance between neighbouring columns. For each c in `sums`, columns are
    symmetric: if there is a column at arc length s, there is one at c - s.
    """
    arcs = np.append(np.linspace(0.0, loop.length, _SAMPLES, endpoint=False), loop.corner_arcs)
    arcs = distinct(np.append(arcs, _beside_corners(loop, largest)))
    size = _sizes(loop, arcs, largest)
    closed = np.append(arcs, loop.length)
    density = 1.0 / np.append(size, size[0])
    count = np.append(0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(closed)))
    begin = 0.5 * sums[0] if sums else 0.0
    starts, multiple = (loop.corner_arcs, 1) if len(loop.corners) else (np.array([begin]), max(len(sums), 1))
    ends = np.append(starts[1:], starts[0] + loop.length)
    firsts, lasts = ([_counted(arc, closed, count, loop.length) for arc in arcs] for arcs in (starts, ends))
    counts = [
        multiple * max(2, round((last - first) / multiple)) for first, last in zip(firsts, lasts, strict=True)
    ]
    for total in (*sums, *sums):  # stretches between corners have as many columns as their images
        for k, end in enumerate(ends.tolist()):
            image = nearest_arc(starts, total - end, loop.length)
            counts[max(k, image)] = counts[min(k, image)]
    columns = []
    for start, first, last, cells in zip(starts, firsts, lasts, counts, strict=True):
        wanted = first + (last - first) * np.arange(cells) / cells
        turns, part = np.divmod(wanted, count[-1])
        column = np.interp(part, count, closed) + turns * loop.length
        column[0] = start  # to the bit: the corner
        columns.append(column)
    arcs = np.concatenate(columns) % loop.length
    return np.asarray(np.roll(arcs, -int(np.argmin(arcs))))


def nearest_arc(arcs: Floats, arc: float, length: float) -> int:
    """Return the index in `arcs` (n,) of the arc length nearest to `arc`, on a closed curve `length` long."""
    off = (arcs - arc) / length
    return int(np.abs(off - np.round(off)).argmin())


def _counted(arc: float, closed: Floats, count: Floats, length: float) -> float:
    turns, part = divmod(arc, length)
    return float(np.interp(part, closed, count) + turns * count[-1])


def _sizes(loop: Loop, arcs: Floats, largest: float) -> Floats:
    """Return the length (n,) of cells at arc lengths (n,)."""
    length = loop.length
    bend = wall_bend(loop, arcs, max(3, round(0.004 * len(arcs))))
    size = np.minimum(largest, TURN / np.maximum(bend, 1e-300))
    size = np.maximum(size, _CORNER_PART * largest)
    for arc, smallest in _at_corners(loop, largest):
        size[np.searchsorted(arcs, arc)] = smallest
    return graded(size, arcs, length, GROWTH)


def _at_corners(loop: Loop, largest: float) -> list[tuple[float, float]]:
    """Return the arc lengths of corners with more than one cell, and the cell lengths there."""
    corners = loop.corner_arcs
    if len(corners) == 0:
        return []
    _, lengths = loop.pieces
    shortest = np.minimum(lengths, np.roll(lengths, 1))
    sizes = np.minimum(_CORNER_PART * largest, _PIECE_PART * shortest)
    every = zip(corners.tolist(), sizes.tolist(), loop.corner_cells, strict=True)
    return [(arc, size) for arc, size, cells in every if cells > 1]


def _beside_corners(loop: Loop, largest: float) -> Floats:
    """Return arc lengths (k,) of more samples beside corners whose cells are far shorter than samples."""
    step = loop.length / _SAMPLES
    beside = [np.zeros(0)]
    for arc, size in _at_corners(loop, largest):
        if 0.0 < size < _RESOLVED * step:
            away = np.ldexp(size, np.arange(math.ceil(math.log2(step / size))))
            beside.append(np.concatenate([arc - away, arc + away]) % loop.length)
    return np.concatenate(beside)
