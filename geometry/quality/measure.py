"""Grid quality: folded cells, and statistics of `meshonet.geometry.quality.metrics`.

A cell is folded if any corner Jacobian is not positive; a grid is valid if no cell is.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, as_planar, norms, percentiles_of
from meshonet.geometry.blocks.block import form_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality import metrics
from meshonet.geometry.quality.cell_run import FEW, PERCENTS, CellRun, run_over, summary_of
from meshonet.geometry.quality.metrics import FACE_NAMES, LINE_METRIC, NAMES, QUAD_METRICS, metric_of
from meshonet.geometry.summary import Quality, Summary
from meshonet.geometry.threads import threads_for
from meshonet.kernels import _native

if TYPE_CHECKING:
    from meshonet.geometry.quality.bad_cell import BadCell


def count_folded(nodes: Floats) -> int:
    """Return the number of folded cells of `nodes` (ni, nj, 2), (ni, nj, nk, 3) or (ni, nj, 3).

    Nodes whose x and y are contiguous arrays (see `meshonet.geometry.arrays`) are not copied.
    """
    form = form_of(nodes)
    if form == "volume":
        from meshonet.geometry.quality.volumes import count_folded_solids

        return count_folded_solids(nodes)
    if form == "surface":
        return len(folded_cells(nodes))
    x, y = np.moveaxis(as_planar(nodes), -1, 0)
    return _native.count_folded(x, y, threads_for(x.size))


def count_folded_in(grid: Grid) -> int:
    """Return the number of folded cells in all blocks of `grid`."""
    return sum(count_folded(block.nodes) for block in grid.blocks)


def folded_cells(nodes: Floats) -> NDArray[np.int64]:
    """Return the ascending indices (n, 2) or (n, 3) of the folded cells of `nodes` (see `count_folded`)."""
    form = form_of(nodes)
    if form == "volume":
        from meshonet.geometry.quality.volumes import folded_solids

        return folded_solids(nodes)
    if form == "surface":
        from meshonet.geometry.quality.surfaces import folded_quads

        return folded_quads(nodes)
    return _native.folded_cells(*np.moveaxis(as_planar(nodes), -1, 0))


def worst_cells(nodes: Floats, limit: int = 10) -> list[BadCell]:
    """Return up to `limit` folded cells of `nodes` (see `count_folded`), the least Jacobian first."""
    form = form_of(nodes)
    if form == "volume":
        from meshonet.geometry.quality.volumes import worst_solids

        return worst_solids(nodes, limit)
    from meshonet.geometry.layout.lattice import corner_jacobians
    from meshonet.geometry.quality.surfaces import bad_cell, worst_quads

    if form == "surface":
        return worst_quads(nodes, limit)
    places = folded_cells(nodes)
    corners = np.stack([nodes[tuple((places + step).T)] for step in ((0, 0), (1, 0), (1, 1), (0, 1))], axis=1)
    lengths = norms(np.roll(corners, -1, axis=1) - corners)
    sizes = lengths * np.roll(lengths, 1, axis=1)
    scaled = np.divide(corner_jacobians(corners), sizes, out=np.zeros_like(sizes), where=sizes > 0)
    order = np.argsort(scaled.min(axis=1), kind="stable")[:limit]
    return [bad_cell(places[k], corners[k].mean(axis=0)) for k in order]


def worst_cells_of(grid: Grid, limit: int = 10) -> list[BadCell]:
    """Return up to `limit` folded cells of `grid`, block after block."""
    if grid.topology != "blocks":
        return worst_cells(grid.nodes, limit)
    blocks = enumerate(grid.blocks)
    cells = [replace(cell, block=k) for k, block in blocks for cell in worst_cells(block.nodes, limit)]
    return cells[:limit]


def measure(grid: Grid, *, percentiles: bool = False) -> Quality:
    """Return the quality of `grid`; cells on both sides of a connection count as neighbours.

    `percentiles` adds the 1st and the 99th percentile of every metric, which takes four times as long as the
    rest.
    """
    quality = _compiled(grid, percentiles)
    if not metrics.METRICS:
        return quality
    summaries = dict(quality.metrics)
    for metric in metrics.METRICS:
        summary = summary_of(metric, per_cell_of_blocks(grid, metric.name), percentiles)
        summaries[metric.name] = (
            summary if grid.topology == "blocks" else replace(summary, worst=summary.worst[1:])
        )
    return replace(quality, metrics=summaries)


def _compiled(grid: Grid, percentiles: bool) -> Quality:
    if grid.form == "volume":
        from meshonet.geometry.quality.volumes import measure_volumes

        return measure_volumes(grid, percentiles=percentiles)
    if grid.topology == "blocks":
        from meshonet.geometry.quality.measure_blocks import measure_blocks

        return measure_blocks(grid, count_folded_in(grid), percentiles=percentiles)
    ni, nj, _ = grid.nodes.shape
    cells = (ni - 1) * (nj - 1)
    together = max(1, FEW * len(QUAD_METRICS) // cells) if percentiles else 0
    run = _run(grid, slice(together))
    summaries = {}
    for k, metric in enumerate(QUAD_METRICS):
        low, mean, high = run.table[k].tolist()
        i, j = run.where[k, 0 if metric.worst == "min" else 1]
        ends: list[float | None] = [None, None]
        if percentiles:
            if k and k % together == 0:
                run = _run(grid, slice(k, k + together))
            ends = [*percentiles_of(run.values[k % together], PERCENTS)]
        summaries[metric.name] = Summary(low, mean, high, (int(i), int(j)), *ends)
    return Quality(cells, count_folded(grid.nodes), summaries)


def _run(grid: Grid, kept: slice) -> CellRun:
    return run_over(grid.nodes, kept, periodic=grid.periodic, wake=grid.wake)


def angles(nodes: Floats) -> tuple[float, float]:
    """Return the largest of all cell angles in degrees, and the mean of each cell's largest angle.

    Both are 360 if cells of `nodes` (ni, nj, 2) are folded.
    """
    if count_folded(nodes):
        return 360.0, 360.0
    table, _ = _angle_table(nodes)
    return float(table[2]), float(table[1])


def widest_cell(nodes: Floats) -> tuple[int, int]:
    """Return the cell (i, j) of `nodes` (ni, nj, 2) with the largest included angle; the first of several."""
    _, where = _angle_table(nodes)
    return int(where[1, 0]), int(where[1, 1])


def _angle_table(nodes: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Return min, mean, max of cells' largest angles, and the cells of min and max."""
    run, k = run_over(nodes), NAMES.index("max_angle")
    return run.table[k], run.where[k]


def per_cell(grid: Grid, name: str) -> Floats:
    """Return the metric `name` (ni-1, nj-1) of all cells of a block. Raises InputError: no such metric."""
    metric = metric_of(grid, name)
    if metric.cells:
        return metric.cells(grid.nodes)
    if name in (LINE_METRIC.name, *FACE_NAMES):
        return per_cell_of_blocks(grid, name)[0]
    k = NAMES.index(name)
    return np.asarray(_run(grid, slice(k, k + 1)).values[0])


def per_cell_of_blocks(grid: Grid, name: str) -> list[Floats]:
    """Return the metric `name` (ni-1, nj-1[, nk-1]) of each block. Raises InputError: no such metric."""
    metric = metric_of(grid, name)
    if metric.cells:
        return [metric.cells(block.nodes) for block in grid.blocks]
    if name in FACE_NAMES:
        from meshonet.geometry.quality.checkmesh import worst_faces

        return worst_faces(grid, name)
    if name == LINE_METRIC.name:
        from meshonet.geometry.quality.lines import growth_of_cells

        return growth_of_cells(grid)
    if grid.form == "volume":
        from meshonet.geometry.quality.volumes import solid_metric

        return solid_metric(grid, name)
    if grid.topology != "blocks":
        return [per_cell(grid, name)]
    from meshonet.geometry.quality.measure_blocks import metrics_of_blocks

    return [cells[NAMES.index(name)] for cells in metrics_of_blocks(grid)]
