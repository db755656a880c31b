"""Folded cells and metrics of volumes: blocks of nodes (ni, nj, nk, 3).

A cell is folded when any of its eight corner Jacobians is not positive. Where all 27 Bezier coefficients of
its Jacobian are positive, that is positive everywhere in the cell (`meshonet.geometry.quality.metrics`);
corners at which an edge has no length are left out of both tests. Kernels work with
`meshonet.geometry.threads.threads_for` threads, results are the same to the bit for any number.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, Side, as_planar
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.connection import cells_at
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import BadCell
from meshonet.geometry.quality.metrics import SOLID_METRICS, SOLID_NAMES
from meshonet.geometry.quality.percentiles import FEW, PERCENTS, CellPass, brackets_of
from meshonet.geometry.quality.surfaces import bad_cell
from meshonet.geometry.summary import Quality, Summary
from meshonet.geometry.threads import threads_for
from meshonet.kernels import _native

CORNERS, BEZIER = 0, 1
"""Tests that cells have to pass."""

_SAMPLE = 1 << 17
"""Cells looked at to bracket percentiles."""
_MARGIN, _ROOM = 1.0, 0.06
"""Percent of the cells that a bracket reaches to each side, and part of all cells there is room for in it."""
_MOST = 1 << 16
"""Folded cells that are looked at for the worst."""


def count_folded_solids(nodes: Floats, test: int = CORNERS) -> int:
    """Return how many cells of `nodes` (ni, nj, nk, 3) do not pass a test, `CORNERS` or `BEZIER`."""
    return int(_folded_rows(as_planar(nodes), test).sum())


def folded_solids(nodes: Floats, test: int = CORNERS) -> NDArray[np.int64]:
    """Return (n, 3) indices (i, j, k) of the cells of `nodes` (ni, nj, nk, 3) that do not pass, in order."""
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
    """Return cells of `nodes` (ni, nj, nk, 3) that do not pass a test, least scaled Jacobian first.

    `limit` of them at most, with their centres.
    """
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
        size = np.sqrt((edges**2).sum(axis=-1)).prod(axis=0)
        jacobian = (edges[0] * np.cross(edges[1], edges[2])).sum(axis=-1)
        scaled = np.divide(jacobian, size, out=np.ones_like(size), where=size > 0)
        least = np.minimum(least, scaled)
    centre = np.asarray(sum(points.values())) / len(points)
    order = np.argsort(least, kind="stable")[:limit]
    return [bad_cell((i[n], j[n], k[n]), centre[n]) for n in order]


def measure_volumes(grid: Grid, *, percentiles: bool = False) -> Quality:
    """Return the quality of all cells of blocks of volume; worst cells are (block, i, j, k)."""
    volumes = padded_volumes(grid)
    cells = sum(_cells(block.nodes) for block in grid.blocks)
    keep = percentiles and cells <= FEW
    run = _Cells(grid, volumes, _brackets(grid, volumes, cells) if percentiles and not keep else None)
    parts = [run.over(number, kept=slice(None) if keep else slice(0)) for number in range(len(grid.blocks))]
    metrics = {}
    for k, metric in enumerate(SOLID_METRICS):
        low = min(range(len(parts)), key=lambda n: float(parts[n].low[k]))
        high = max(range(len(parts)), key=lambda n: float(parts[n].high[k]))
        block = low if metric.worst == "min" else high
        where = parts[block].where[k, 0 if metric.worst == "min" else 1]
        ends: list[float | None] = [None, None]
        if percentiles:
            ends = run.percentiles(k, cells, [part.kept[k] for part in parts] if keep else None)
        mean = float(sum(float(part.total[k]) for part in parts)) / cells
        span = float(parts[low].low[k]), mean, float(parts[high].high[k])
        metrics[metric.name] = Summary(*span, (block, *map(int, where)), *ends)
    folded = sum(count_folded_solids(block.nodes) for block in grid.blocks)
    doubtful = folded
    if metrics["bezier_ratio"].min <= 0:
        doubtful = sum(count_folded_solids(block.nodes, BEZIER) for block in grid.blocks)
    return Quality(cells, folded, metrics, doubtful)


def solid_metric(grid: Grid, name: str) -> list[Floats]:
    """Return the metric `name` of every cell, (ni-1, nj-1, nk-1) for each block of volume."""
    k = SOLID_NAMES.index(name)
    run = _Cells(grid, padded_volumes(grid), None)
    return [run.over(number, kept=slice(k, k + 1)).kept[0] for number in range(len(grid.blocks))]


def padded_volumes(grid: Grid) -> list[Floats]:
    """Return the volumes (ni+1, nj+1, nk+1) of the cells of each block, with a layer of cells around.

    The layer has the cells beyond connections, and elsewhere the block's own again.
    """
    padded = []
    for block in grid.blocks:
        sizes = np.zeros([count + 1 for count in block.counts])
        _native.solids_volumes(block.nodes, threads_for(sizes.size), sizes)
        for axis in range(3):
            layers = np.moveaxis(sizes, axis, 0)
            layers[0], layers[-1] = layers[1], layers[-2]
        padded.append(sizes)

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


@dataclass(frozen=True)
class _BlockRange:
    """What one run over a block leaves, for each metric: ends, sum, place of the ends (2, 3), kept values."""

    low: Floats
    total: Floats
    high: Floats
    where: NDArray[np.int64]
    kept: Floats


class _Cells:
    """Runs over the cells of blocks; they keep values between brackets (metrics, percentiles, 2)."""

    def __init__(self, grid: Grid, volumes: Sequence[Floats], brackets: Floats | None) -> None:
        self._grid, self._volumes = grid, volumes
        metrics = len(SOLID_METRICS)
        self._brackets = np.empty((metrics, 0, 2)) if brackets is None else brackets
        size = self._brackets.shape[:2]
        cells = sum(_cells(block.nodes) for block in grid.blocks)
        self._caught = np.empty((*size, int(_ROOM * cells) + 1 if size[1] else 1))
        self._held = np.zeros(size, dtype=np.int64)
        self._counts = np.zeros((*size, 4), dtype=np.int64)

    def over(self, number: int, kept: slice = slice(0)) -> _BlockRange:
        """Run over a block and keep the values of some metrics, (n, ni-1, nj-1, nk-1)."""
        nodes = self._grid.blocks[number].nodes
        chunks, metrics = _native.solids_chunks(nodes), len(SOLID_METRICS)
        summary = np.empty((chunks, metrics, 3))
        where = np.empty((chunks, metrics, 2, 3), dtype=np.int64)
        counts = np.zeros((chunks, *self._counts.shape), dtype=np.int64)
        first, last, _ = kept.indices(metrics)
        values = np.empty((last - first, *(count - 1 for count in nodes.shape[:3])))
        _native.solids_run(
            nodes, self._volumes[number], summary, where, first, values,
            self._brackets, counts, self._caught, self._held, threads_for(nodes[..., 0].size),
        )  # fmt: skip
        self._counts += counts.sum(axis=0)
        low, high = summary[..., 0].argmin(axis=0), summary[..., 2].argmax(axis=0)
        every = np.arange(metrics)
        places = np.stack([where[low, every, 0], where[high, every, 1]], axis=1)
        ends = summary[low, every, 0], summary[..., 1].sum(axis=0), summary[high, every, 2]
        return _BlockRange(*ends, places, values)

    def percentiles(self, k: int, cells: int, values: Sequence[Floats] | None) -> list[float | None]:
        """Return the percentiles of metric `k`, from all of its values where these are known."""
        if values is None:
            run = CellPass(self._brackets, self._counts, self._caught)
            ends = [run.percentile(k, m, cells, percent) for m, percent in enumerate(PERCENTS)]
            if None not in ends:
                return ends
            values = solid_metric(self._grid, SOLID_NAMES[k])
        every = np.concatenate([part.ravel() for part in values])
        return [float(value) for value in np.percentile(every, PERCENTS, overwrite_input=True)]


def _brackets(grid: Grid, volumes: Sequence[Floats], cells: int) -> Floats:
    """Return pairs of values (metrics, percentiles, 2) of which each percentile is probably between."""
    share = min(1.0, _SAMPLE / cells)
    samples = []
    for block, sizes in zip(grid.blocks, volumes, strict=True):
        ni, nj, nk = (count - 1 for count in block.counts)
        n = max(1, int(share * ni * nj))
        i = np.linspace(0, ni - 1, n).round().astype(np.int64)
        j = (np.arange(n) * 0.6180339887498949 % 1.0 * nj).astype(np.int64)
        values = np.empty((len(SOLID_METRICS), n, nk))
        _native.solids_rows(block.nodes, sizes, np.stack([i, j], axis=1), values)
        samples.append(values.reshape(len(SOLID_METRICS), -1))
    return brackets_of(np.concatenate(samples, axis=1), PERCENTS, _MARGIN)


def _cells(nodes: Floats) -> int:
    return int(np.prod([count - 1 for count in nodes.shape[:3]]))
