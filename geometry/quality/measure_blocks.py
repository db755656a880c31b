"""The metrics of a multi-block grid, or of surface patches, whose cells are measured as one grid.

Cells across connections are neighbours.
"""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats, percentiles_of
from meshonet.geometry.blocks.across import across
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.cell_run import PERCENTS, run_over
from meshonet.geometry.quality.metrics import NAMES, QUAD_METRICS, Metric
from meshonet.geometry.quality.surfaces import areas, quad_metrics
from meshonet.geometry.summary import Quality, Summary

_TINY, _LARGE = 1e-300, 1e30
"""A cell without area has a neighbour of ratio `_LARGE`, as in the compiled metrics."""


def measure_blocks(grid: Grid, folded: int, *, percentiles: bool = False) -> Quality:
    """Return the quality of all cells of planar blocks or surface patches, of which `folded` are folded.

    The places of worst cells are (block, i, j).
    """
    values = metrics_of_blocks(grid)
    metrics = {
        metric.name: summary_of(metric, [cells[k] for cells in values], percentiles)
        for k, metric in enumerate(QUAD_METRICS)
    }
    return Quality(sum(cells[0].size for cells in values), folded, metrics)


def metrics_of_blocks(grid: Grid) -> list[Floats]:
    """Return every metric of `QUAD_METRICS` of every cell, (metrics, ni-1, nj-1) for each block."""
    nodes = [block.nodes for block in grid.blocks]
    if grid.form == "surface":
        values = [quad_metrics(each) for each in nodes]
    else:
        values = [run_over(each[..., 0], each[..., 1], slice(None)).values for each in nodes]
    _area_ratios_across(grid, [cells[NAMES.index("area_ratio")] for cells in values])
    return values


def _area_ratios_across(grid: Grid, ratios: Sequence[Floats]) -> None:
    """Raise the area ratios (ni-1, nj-1) of cells at connections to those with the cells across, in place."""
    for each in grid.connections:
        own, donor = (areas(rows)[0] for rows in across(grid, each, 2))
        large, small = np.maximum(own, donor), np.maximum(np.minimum(own, donor), _TINY)
        ratio = np.minimum(large / small, _LARGE)
        for (block, side, span), way in zip(each.ends, (1, each.orientation[0]), strict=True):
            axis, end = PLACES[side]
            beside = np.moveaxis(ratios[block], axis, 0)[end, span[0][0] : span[0][1]]
            np.maximum(beside, ratio[::way], out=beside)


def summary_of(metric: Metric, blocks: Sequence[Floats], percentiles: bool) -> Summary:
    """Return the statistics of a metric from its values (ni-1, nj-1[, nk-1]) in the cells of each block."""
    ends = [cells.min() if metric.worst == "min" else -cells.max() for cells in blocks]
    block = int(np.argmin(ends))
    cells = blocks[block]
    at = np.argmin(cells) if metric.worst == "min" else np.argmax(cells)
    every = np.concatenate([cells.ravel() for cells in blocks])
    low, mean, high = float(every.min()), float(every.mean()), float(every.max())
    part = percentiles_of(every, PERCENTS) if percentiles else [None, None]
    return Summary(low, mean, high, (block, *map(int, np.unravel_index(at, cells.shape))), *part)
