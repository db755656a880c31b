"""The metrics of a multi-block grid, or of surface patches; cells across connections are neighbours."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.across import across
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.cell_run import run_over, summary_of
from meshonet.geometry.quality.metrics import NAMES, QUAD_METRICS
from meshonet.geometry.quality.surfaces import areas, quad_metrics
from meshonet.geometry.summary import Quality

_TINY, _LARGE = 1e-300, 1e30  # ratio of areas next to a cell without area, as in the compiled metrics


def measure_blocks(grid: Grid, folded: int, *, percentiles: bool = False) -> Quality:
    """Return the quality of planar blocks or patches; `folded` is their number of folded cells."""
    values = metrics_of_blocks(grid)
    metrics = {
        metric.name: summary_of(metric, [cells[k] for cells in values], percentiles)
        for k, metric in enumerate(QUAD_METRICS)
    }
    return Quality(sum(cells[0].size for cells in values), folded, metrics)


def metrics_of_blocks(grid: Grid) -> list[Floats]:
    """Return, for each block, all `QUAD_METRICS` of all cells, (metrics, ni-1, nj-1)."""
    nodes = [block.nodes for block in grid.blocks]
    if grid.form == "surface":
        values = [quad_metrics(each) for each in nodes]
    else:
        values = [run_over(each, slice(None)).values for each in nodes]
    _area_ratios_across(grid, [cells[NAMES.index("area_ratio")] for cells in values])
    return values


def _area_ratios_across(grid: Grid, ratios: Sequence[Floats]) -> None:
    """Raise area ratios (ni-1, nj-1) of cells at connections to those with the cells across."""
    for each in grid.connections:
        own, donor = (areas(rows)[0] for rows in across(grid, each, 2))
        large, small = np.maximum(own, donor), np.maximum(np.minimum(own, donor), _TINY)
        ratio = np.minimum(large / small, _LARGE)
        for (block, side, span), way in zip(each.ends, (1, each.orientation[0]), strict=True):
            axis, end = PLACES[side]
            beside = np.moveaxis(ratios[block], axis, 0)[end, span[0][0] : span[0][1]]
            np.maximum(beside, ratio[::way], out=beside)
