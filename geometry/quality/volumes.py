"""Folded cells and metrics of volumes, blocks of nodes (ni, nj, nk, 3), for any number of threads.

Corners with an edge of zero length are left out. Definitions: `meshonet.geometry.quality.metrics`.
"""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Side, as_planar, norms, percentiles_of
from meshonet.geometry.blocks.block import PLACES, Block
from meshonet.geometry.blocks.connection import cells_at
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.bad_cell import BadCell
from meshonet.geometry.quality.cell_run import FEW, NONE, PERCENTS
from meshonet.geometry.quality.metrics import SOLID_METRICS, SOLID_NAMES
from meshonet.geometry.quality.surfaces import bad_cell
from meshonet.geometry.summary import Quality, Summary
from meshonet.geometry.threads import over_blocks, threads_for
from meshonet.kernels import _native

CORNERS, BEZIER = 0, 1  # tests for folded cells, by corner Jacobians or Bezier coefficients
_MOST = 1 << 16  # largest number of folded cells that are searched for the worst


def count_folded_solids(nodes: Floats, test: int = CORNERS) -> int:
    """Return how many cells of `nodes` (ni, nj, nk, 3) are folded by a test, `CORNERS` or `BEZIER`."""
    return int(_folded_rows(as_planar(nodes), test).sum())


def folded_solids(nodes: Floats, test: int = CORNERS) -> NDArray[np.int64]:
    """Return the ascending indices (n, 3) of cells of `nodes` (ni, nj, nk, 3) that `test` finds folded."""
    nodes = as_planar(nodes)
    rows = _folded_rows(nodes, test)
    places = np.empty((int(rows.sum()), 3), dtype=np.int64)
    if len(places):
        _native.solids_places(nodes, test, rows, places)
    return places


def _folded_rows(nodes: Floats, test: int) -> NDArray[np.int64]:
    rows = np.empty((nodes.shape[0] - 1, nodes.shape[1] - 1), dtype=np.int64)
    _native.solids_folded(nodes, test, threads_for(nodes[..., 0].size), rows)
    return rows


def worst_solids(nodes: Floats, limit: int = 10, test: int = CORNERS) -> list[BadCell]:
    """Return up to `limit` cells of `nodes` that are folded by the `test`, by ascending scaled Jacobian."""
    i, j, k = folded_solids(nodes, test)[:_MOST].T
    points = {(a, b, c): nodes[i + a, j + b, k + c] for a in (0, 1) for b in (0, 1) for c in (0, 1)}
    least = np.ones(len(i))
    for a, b, c in points:
        edges = np.stack(
            [
                points[1, b, c] - points[0, b, c],
                points[a, 1, c] - points[a, 0, c],
                points[a, b, 1] - points[a, b, 0],
            ]
        )
        size = norms(edges).prod(axis=0)
        jacobian = (edges[0] * np.cross(edges[1], edges[2])).sum(axis=-1)
        scaled = np.divide(jacobian, size, out=np.ones_like(size), where=size > 0)
        least = np.minimum(least, scaled)
    centre = np.asarray(sum(points.values())) / len(points)
    order = np.argsort(least, kind="stable")[:limit]
    return [bad_cell((i[n], j[n], k[n]), centre[n]) for n in order]


def measure_volumes(grid: Grid, *, percentiles: bool = False) -> Quality:
    """Return the quality of volumes; the places of worst cells are (block, i, j, k)."""
    volumes = padded_volumes(grid)
    cells = grid.cells
    kept = slice(None) if percentiles and cells <= FEW else NONE
    pairs = list(zip(grid.blocks, volumes, strict=True))
    runs = over_blocks(lambda pair: _run_over(*pair, kept), pairs, _nodes_of(grid))
    low, high = np.stack([run.low for run in runs]), np.stack([run.high for run in runs])
    total = np.sum([run.total for run in runs], axis=0)
    metrics = {}
    for k, metric in enumerate(SOLID_METRICS):
        end = 0 if metric.worst == "min" else 1
        block = int(high[:, k].argmax() if end else low[:, k].argmin())
        ends: list[float | None] = [None, None]
        if percentiles:
            parts = [run.values[k] for run in runs] if kept != NONE else _metric(grid, volumes, k)
            ends = [*percentiles_of(np.concatenate([part.ravel() for part in parts]), PERCENTS)]
        span = float(low[:, k].min()), float(total[k]) / cells, float(high[:, k].max())
        metrics[metric.name] = Summary(*span, (block, *map(int, runs[block].where[k, end])), *ends)
    folded = _folded_of(grid, CORNERS)
    doubtful = _folded_of(grid, BEZIER) if metrics["bezier_ratio"].min <= 0 else folded
    return Quality(cells, folded, metrics, doubtful)


def least_jacobian(blocks: Sequence[Block]) -> float:
    """Return the least scaled Jacobian of all cells of volumes."""
    where = SOLID_NAMES.index("scaled_jacobian")

    def least(block: Block) -> float:
        no_volumes = np.ones([count + 1 for count in block.counts])
        return float(_run_over(block, no_volumes, NONE).low[where])

    return min(over_blocks(least, blocks, [block.nodes[..., 0].size for block in blocks]))


def _folded_of(grid: Grid, test: int) -> int:
    return sum(
        over_blocks(lambda block: count_folded_solids(block.nodes, test), grid.blocks, _nodes_of(grid))
    )


def _nodes_of(grid: Grid) -> list[int]:
    return [block.nodes[..., 0].size for block in grid.blocks]


def solid_metric(grid: Grid, name: str) -> list[Floats]:
    """Return, for each block of a grid of volumes, the metric `name` (ni-1, nj-1, nk-1) of its cells."""
    return _metric(grid, padded_volumes(grid), SOLID_NAMES.index(name))


def _metric(grid: Grid, volumes: Sequence[Floats], k: int) -> list[Floats]:
    pairs = zip(grid.blocks, volumes, strict=True)
    return [_run_over(block, own, slice(k, k + 1)).values[0] for block, own in pairs]


def padded_volumes(grid: Grid) -> list[Floats]:
    """Return, for each block, the volumes (ni+1, nj+1, nk+1) of its cells and of a layer of cells around it.

    Across a connection, this layer has the volumes of the neighbour's cells; elsewhere, it repeats the
    volumes of the nearest cells.
    """
    padded = over_blocks(_padded, grid.blocks, _nodes_of(grid))

    def layer(depth: int) -> Callable[[int, Side], NDArray[Any]]:
        def face(block: int, side: Side) -> NDArray[Any]:
            axis, end = PLACES[side]
            layers = np.moveaxis(padded[block], axis, 0)
            return layers[depth if end == 0 else -1 - depth, 1:-1, 1:-1, None]

        return face

    for each in grid.connections:
        own, donor = cells_at(each, layer(1))
        beyond, before = cells_at(each, layer(0))
        if own.shape == donor.shape:
            beyond[...], before[...] = donor, own
    return padded


def _padded(block: Block) -> Floats:
    """Return the cell volumes of a block, repeated in one layer of cells around it."""
    sizes = np.zeros([count + 1 for count in block.counts])
    _native.solids_volumes(block.nodes, threads_for(sizes.size), sizes)
    for axis in range(3):
        layers = np.moveaxis(sizes, axis, 0)
        layers[0], layers[-1] = layers[1], layers[-2]
    return sizes


class _BlockRun(NamedTuple):
    """Result of a pass, per metric: extremes, sum, their cells (2, 3), kept values."""

    low: Floats
    total: Floats
    high: Floats
    where: NDArray[np.int64]
    values: Floats


def _run_over(block: Block, volumes: Floats, kept: slice) -> _BlockRun:
    """Return the metrics of a block, and values (n, ni-1, nj-1, nk-1) of those `kept`."""
    chunks, metrics = _native.solids_chunks(block.nodes), len(SOLID_METRICS)
    summary, where = np.empty((chunks, metrics, 3)), np.empty((chunks, metrics, 2, 3), dtype=np.int64)
    first, last, _ = kept.indices(metrics)
    values = np.empty((last - first, *(count - 1 for count in block.counts)))
    threads = threads_for(block.nodes[..., 0].size)
    _native.solids_run(block.nodes, volumes, summary, where, first, values, threads)
    low, high, every = summary[..., 0].argmin(axis=0), summary[..., 2].argmax(axis=0), np.arange(metrics)
    places = np.stack([where[low, every, 0], where[high, every, 1]], axis=1)
    return _BlockRun(
        summary[low, every, 0], summary[..., 1].sum(axis=0), summary[high, every, 2], places, values
    )
