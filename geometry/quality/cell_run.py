"""One pass of the compiled metrics over all cells of a planar block, and the statistics of a metric."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, as_planar, percentiles_of
from meshonet.geometry.quality.metrics import QUAD_METRICS, Metric
from meshonet.geometry.summary import Summary
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import measure_cells

PERCENTS = (1.0, 99.0)  # percentiles of reports
FEW = 1 << 22  # most cells for which the values of all metrics are in memory at once
NONE = slice(0)  # slice of no metric


class CellRun(NamedTuple):
    """Result of one pass over the cells of a block.

    `table` (metrics, 3) has the minimum, mean and maximum of each metric. `where` (metrics, 2, 2) has the
    cell i, j of the minimum and of the maximum. `values` (n, ni-1, nj-1) has n chosen metrics of all
    cells.
    """

    table: Floats
    where: NDArray[np.int64]
    values: Floats


def run_over(nodes: Floats, kept: slice = NONE, *, periodic: bool = False, wake: int = 0) -> CellRun:
    """Return statistics of all metrics of `nodes` (ni, nj, 2), and the values of the metrics `kept`.

    In a `periodic` block, nodes with i = 0 and i = ni-1 coincide. On the south side, the first `wake` cells
    touch the last `wake` cells.
    """
    metrics, (x, y) = len(QUAD_METRICS), np.moveaxis(as_planar(nodes), -1, 0)
    table, where = np.empty((metrics, 3)), np.empty((metrics, 2, 2), dtype=np.int64)
    first, last, _ = kept.indices(metrics)
    values = np.empty((last - first, len(x) - 1, x.shape[1] - 1))
    measure_cells(x, y, periodic, wake, table, where, first, values, threads_for(x.size))
    return CellRun(table, where, values)


def summary_of(metric: Metric, blocks: Sequence[Floats], percentiles: bool) -> Summary:
    """Return the statistics of a metric from its values (ni-1, nj-1[, nk-1]) in each block."""
    ends = [cells.min() if metric.worst == "min" else -cells.max() for cells in blocks]
    block = int(np.argmin(ends))
    cells = blocks[block]
    at = np.argmin(cells) if metric.worst == "min" else np.argmax(cells)
    every = np.concatenate([cells.ravel() for cells in blocks])
    low, mean, high = float(every.min()), float(every.mean()), float(every.max())
    part = percentiles_of(every, PERCENTS) if percentiles else [None, None]
    return Summary(low, mean, high, (block, *map(int, np.unravel_index(at, cells.shape))), *part)
