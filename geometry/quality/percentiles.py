"""Percentiles of every metric over all cells, exact, without keeping the values of all cells.

A sample of tiles brackets each percentile between two values. One run over all cells counts the values below
the bracket and keeps those inside, a few hundredths of all; the percentile is among them. Where a bracket
misses, or holds too many, all values of that metric are used. Either way the result equals that of
`numpy.percentile` (linear interpolation between cells) to the last bit.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.metrics import QUAD_METRICS
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import measure_cells

PERCENTS = (1.0, 99.0)
"""Those that are asked for."""

FEW = 1 << 18
"""Cells up to which percentiles come from the values of all cells."""

TILES, TILE = 4096, 8
"""Tiles of the sample, and their cells along each direction."""

MARGIN = 0.3
"""Percent of the cells that a bracket reaches to each side of its percentile."""

ROOM = 0.03
"""Part of all cells that there is room for in a bracket."""


@dataclass(frozen=True)
class CellPass:
    """What one run over all cells needs beforehand and leaves behind, see `kernels.measure_cells`.

    (metrics, percentiles, 2), (metrics, percentiles, 4) and (metrics, percentiles, room) numbers.
    """

    brackets: Floats
    counts: NDArray[np.int64]
    caught: Floats

    def over(
        self, x: Floats, y: Floats, values: Floats, periodic: bool = False, wake: int = 0, first: int = 0
    ) -> tuple[Floats, NDArray[np.int64]]:
        """Run over all cells; return min, mean, max (metrics, 3), and where min and max are (metrics, 2, 2).

        `values` (n, ni-1, nj-1) is filled with n metrics from the `first` on.
        """
        table, where = np.empty((len(QUAD_METRICS), 3)), np.empty((len(QUAD_METRICS), 2, 2), dtype=np.int64)
        tallies = self.brackets, self.counts, self.caught
        measure_cells(x, y, periodic, wake, table, where, first, values, *tallies, threads_for(x.size))
        return table, where

    def percentile(self, metric: int, which: int, cells: int, percent: float) -> float | None:
        """Return percentile number `which` of a metric, None when the bracket does not hold it."""
        at = (cells - 1) * (percent / 100)
        first = int(at)
        pair = [self._ranked(metric, which, rank) for rank in (first, min(first + 1, cells - 1))]
        if pair[0] is None or pair[1] is None:
            return None
        low, high, t = pair[0], pair[1], at - first
        # numpy's own order of operations, which makes the last bit the same
        return high - (high - low) * (1 - t) if t >= 0.5 else low + (high - low) * t

    def _ranked(self, metric: int, which: int, rank: int) -> float | None:
        """Return the value that `rank` others come before."""
        before, up_to, below, all_up_to = (int(count) for count in self.counts[metric, which])
        low, high = (float(end) for end in self.brackets[metric, which])
        if before <= rank < up_to:
            return low
        if below <= rank < all_up_to:
            return high
        held = self.caught[metric, which, : below - up_to]
        if not up_to <= rank < below or len(held) < below - up_to:
            return None
        return float(np.partition(held, rank - up_to)[rank - up_to])


def no_run() -> CellPass:
    """Return a run that looks for nothing."""
    n = len(QUAD_METRICS)
    return CellPass(np.empty((n, 0, 2)), np.zeros((n, 0, 4), dtype=np.int64), np.empty((n, 0, 1)))


def prepared(x: Floats, y: Floats, percents: tuple[float, ...]) -> CellPass:
    """Return a run that brackets the percentiles `percents` of every metric of the grid (ni, nj)."""
    brackets = brackets_of(_sample(x, y), percents, MARGIN)
    n = len(QUAD_METRICS)
    room = int(ROOM * (x.shape[0] - 1) * (x.shape[1] - 1)) + 1
    return CellPass(
        brackets, np.zeros((n, len(percents), 4), dtype=np.int64), np.empty((n, len(percents), room))
    )


def brackets_of(sample: Floats, percents: tuple[float, ...], margin: float) -> Floats:
    """Return the values (metrics, percents, 2) of a `sample` (metrics, n) `margin` percent to each side."""
    ends = [(max(0.0, p - margin), min(100.0, p + margin)) for p in percents]
    values = np.percentile(sample, np.ravel(ends), axis=1, method="nearest", overwrite_input=True)
    return np.ascontiguousarray(values.T).reshape(len(sample), len(percents), 2)


def _sample(x: Floats, y: Floats) -> Floats:
    """Return the metrics (metrics, n) of tiles that cover the grid evenly.

    Tiles stand on a lattice of rank one, steps of the golden ratio across: what fills a hundredth of the grid
    fills about a hundredth of the tiles. Those at the sides reach beyond the grid, or its outermost cells
    would be in fewer tiles than the others. All of them side by side make one grid to run over.
    """
    n = len(QUAD_METRICS)
    i, inside_i = _tiles(np.linspace(0, 1, TILES), x.shape[0] - 1)
    j, inside_j = _tiles(np.arange(TILES) * 0.6180339887498949 % 1.0, x.shape[1] - 1)
    tiles = (np.swapaxes(plane[i[:, :, None], j[:, None, :]], 0, 1) for plane in (x, y))
    u, v = (tile.reshape(i.shape[1], -1) for tile in tiles)
    values = np.empty((n, i.shape[1] - 1, u.shape[1] - 1))
    no_run().over(u, v, values)
    inside = np.zeros((TILES, i.shape[1] - 1, j.shape[1]), dtype=bool)
    # the last column of a tile joins it to the next one
    inside[..., :-1] = inside_i[:, :, None] & inside_j[:, None, :]
    return values[:, inside.swapaxes(0, 1).reshape(i.shape[1] - 1, -1)[:, :-1]]


def _tiles(t: NDArray[np.floating[Any]], cells: int) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Return the nodes (tiles, size + 3) of tiles with a cell more to each side, placed by t from 0 to 1.

    Beyond its ends the grid is mirrored, so that cells there have neighbours of their own area. The second
    result (tiles, size + 2) says which cells are in the tile and in the grid.
    """
    size = min(TILE, cells)
    start = np.rint(t * (cells + size - 2)).astype(np.intp) - (size - 1)
    cell = start[:, None] + np.arange(-1, size + 1)
    inside = (cell >= 0) & (cell < cells)
    inside[:, [0, -1]] = False
    node = np.append(cell, cell[:, -1:] + 1, axis=1)
    return cells - np.abs(cells - np.abs(node)), inside
