"""Quality metrics in an interactive page: values as integers, their histogram, and the worst cells."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.metrics import Metric

BARS = 48  # number of bars of a histogram
LEVELS = 65535  # number of levels between the smallest and the largest value to which values are rounded
_RATIO = 50.0  # ratio of the 99th to the 1st percentile above which a scale is logarithmic
_CANDIDATES = 20_000  # number of worst cells from which the listed ones are selected
_NEAR = 3  # smallest distance between two listed cells, in cells
_NEAR_PART = 0.06  # smallest distance between listed cells relative to the number of cells along a direction


@dataclass(frozen=True)
class Scale:
    """A colour scale from `low` to `high`; 98 % of the values are between `start` and `stop`."""

    low: float
    high: float
    log: bool
    start: float
    stop: float

    def parts(self, values: Floats) -> Floats:
        """Return the positions of `values` on the scale, which are 0 for `low` and 1 for `high`."""
        turn = np.log if self.log else np.positive
        low, high = turn(self.low), turn(self.high)
        return np.asarray((turn(values) - low) / max(high - low, 1e-300))


def scale_of(values: Floats) -> Scale:
    """Return the colour scale for `values` (n,)."""
    low, high = float(values.min()), float(values.max())
    start, stop = (float(value) for value in np.percentile(values, (1, 99)))
    log = low > 0 and stop > _RATIO * start
    stop = max(stop, start + 1e-9 * abs(start) + 1e-30)
    return Scale(low, high, log, start, stop)


def histogram(values: Floats, scale: Scale) -> list[int]:
    """Return how many `values` are in each of `BARS` equal intervals; the outer ones include outliers."""
    first, last = scale.parts(np.array([scale.start, scale.stop]))
    part = (scale.parts(values) - first) / max(last - first, 1e-300)
    bar = np.clip((part * BARS).astype(np.int64), 0, BARS - 1)
    return np.bincount(bar, minlength=BARS).tolist()


def worst_places(
    values: Sequence[Floats], metric: Metric, most: int = 10
) -> Iterator[tuple[int, tuple[int, ...], float]]:
    """Yield block, cell indices and value of the worst cells; neighbours of a yielded cell are skipped.

    `values` are the cell values of each block.
    """
    every = np.concatenate([cells.ravel() for cells in values])
    badness = every if metric.worst == "min" else -every
    count = min(len(every), _CANDIDATES)
    order = np.argpartition(badness, count - 1)[:count]
    order = order[np.argsort(badness[order], kind="stable")]
    ends = np.cumsum([cells.size for cells in values])
    chosen: dict[int, list[NDArray[Any]]] = {}
    shown = 0
    for cell in order.tolist():
        block = int(np.searchsorted(ends, cell, side="right"))
        cells = values[block]
        at = np.array(np.unravel_index(cell - (int(ends[block]) - cells.size), cells.shape))
        beside = chosen.setdefault(block, [])
        near = np.maximum(_NEAR, _NEAR_PART * np.array(cells.shape))
        if any((np.abs(at - other) <= near).all() for other in beside):
            continue
        beside.append(at)
        yield block, tuple(at.tolist()), float(every[cell])
        shown += 1
        if shown == most:
            return


def corners_of(grid: Grid, block: int, cell: tuple[int, ...]) -> Floats:
    """Return the corners (4, d) or (8, 3) of a cell, ordered by their indices, the last index fastest."""
    nodes = grid.blocks[block].nodes
    part = nodes[tuple(slice(index, index + 2) for index in cell)]
    return part.reshape(-1, nodes.shape[-1])
