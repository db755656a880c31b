"""Data of a grid in an interactive page: lattices of nodes, sheets of cells, metrics, worst cells.

A lattice is a block, or a patch of a volume too large for a page; a sheet is a drawn layer of its cells.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from meshonet.formats.figure.page.cells import LEVELS, Scale, corners_of, histogram, scale_of, worst_places
from meshonet.formats.figure.page.packing import Packed, packed, rounding_step, shortest_edge
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import irregular_points
from meshonet.geometry.quality.measure import per_cell_of_blocks
from meshonet.geometry.quality.metrics import Metric, metric_of, metrics_of

MOST_NODES = 1_500_000  # most nodes of a volume that is on the page as a whole, not by boundary and layers
_AROUND = 5  # cells to each side of a bad one whose lines a page of such a volume has
_LAYERS = 3  # fewest layers across each direction of such a volume


@dataclass(frozen=True, eq=False)
class Lattice:
    """Nodes (ni, nj, 2 or 3) or (ni, nj, nk, 3) of a block, or of one layer of nodes of a volume block.

    `start` is its first cell in the block, and `fixed` (0, 1 or 2) the direction normal to a layer.
    """

    block: int
    nodes: Floats
    start: tuple[int, ...]
    fixed: int | None = None

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of nodes along each direction."""
        return self.nodes.shape[:-1]

    def facts(self) -> dict[str, Any]:
        """Return the description of the lattice for the JavaScript of the page."""
        facts: dict[str, Any] = {"block": self.block, "counts": list(self.counts), "start": list(self.start)}
        return facts if self.fixed is None else facts | {"fixed": self.fixed}


@dataclass(frozen=True)
class SceneSheet:
    """A layer of cells to draw: a planar or surface block, a patch of a volume, or a layer inside a volume.

    Array number `lattice` of the page contains its nodes. If `axis` is None, the array has no others;
    otherwise the layer is at index `node` along direction number `axis` of the array. `ranges` are the first
    and last nodes along the two directions of the layer. `across` and `at` are for a layer inside a volume:
    it consists of the nodes with index `at` along direction `across` (i, j or k) of the volume's block.
    """

    lattice: int
    part: str
    kind: str
    axis: int | None
    node: int
    ranges: tuple[tuple[int, int], ...]
    across: str = ""
    at: int = 0

    def facts(self) -> dict[str, Any]:
        """Return all fields by name, for the JavaScript of the page."""
        return dict(vars(self))


@dataclass(frozen=True, eq=False)
class Scene:
    """Content of a page: descriptions for JSON, and compressed arrays of numbers by name."""

    facts: dict[str, Any]
    numbers: dict[str, Packed] = field(default_factory=dict)


def scene_of(grid: Grid, layer: tuple[str, int] | None = None, shown: str | None = None) -> Scene:
    """Return the content of the page of a grid with all its metrics; the metric `shown` comes first.

    A large volume shows its patches, some layers, and `layer`: a direction (i, j or k) and an index.
    """
    lattices, sheets = _whole(grid) if _fits(grid) else _in_part(grid, layer)
    low = np.min([lattice.nodes.reshape(-1, lattice.nodes.shape[-1]).min(axis=0) for lattice in lattices], 0)
    high = np.max([lattice.nodes.reshape(-1, lattice.nodes.shape[-1]).max(axis=0) for lattice in lattices], 0)
    extent = float((high - low).max()) or 1.0
    step = rounding_step(min(shortest_edge(lattice.nodes, extent) for lattice in lattices), extent)
    numbers = {
        name: packed(_whole_numbers([(each.nodes[..., axis] - low[axis]) / step for each in lattices]))
        for axis, name in enumerate("xyz"[: len(low)])
    }
    metrics = []
    for metric in dict.fromkeys((*metrics_of(grid), *((metric_of(grid, shown),) if shown else ()))):
        values = [np.asarray(cells) for cells in per_cell_of_blocks(grid, metric.name)]
        scale = scale_of(np.concatenate([cells.ravel() for cells in values]))
        metrics.append(_metric(grid, metric, values, scale))
        levels = [scale.parts(_of(lattice, values)) * LEVELS for lattice in lattices]
        numbers[metric.name] = packed(_whole_numbers(levels))
    facts = {
        "form": grid.form,
        "cells": grid.cells,
        "blocks": [list(block.counts) for block in grid.blocks],
        "box": [low.tolist(), high.tolist()],
        "step": step,
        "whole": _fits(grid),
        "lattices": [lattice.facts() for lattice in lattices],
        "sheets": [sheet.facts() for sheet in sheets],
        "metrics": metrics,
        "walls": _walls(grid),
        **(_edges(grid) if grid.form == "plane" else {}),
    }
    return Scene(facts, numbers)


def _walls(grid: Grid) -> list[list[float]] | None:
    """Return the lowest and highest coordinates of the walls; None if there are no walls."""
    nodes = [grid.at(patch).reshape(-1, grid.blocks[0].nodes.shape[-1]) for patch in grid.walls()]
    if not nodes:
        return None
    every = np.concatenate(nodes)
    return [every.min(axis=0).tolist(), every.max(axis=0).tolist()]


def _edges(grid: Grid) -> dict[str, Any]:
    """Return the outer boundary of a planar grid, and its irregular vertices."""
    edges = [
        {"block": patch.block, "axis": patch.place[0], "end": patch.place[1], "start": patch.start,
         "stop": patch.stop, "name": patch.name, "kind": patch.kind}
        for patch in grid.outer_patches()
    ]  # fmt: skip
    points, cells = irregular_points(grid)
    vertices = [{"x": x, "y": y, "cells": int(n)} for (x, y), n in zip(points.tolist(), cells, strict=True)]
    return {"edges": edges, "vertices": vertices}


def _fits(grid: Grid) -> bool:
    nodes = sum(int(np.prod(block.counts)) for block in grid.blocks)
    return grid.form != "volume" or nodes <= MOST_NODES


def _whole(grid: Grid) -> tuple[list[Lattice], list[SceneSheet]]:
    """Return all blocks as lattices, and the sheets that show their cells or patches."""
    lattices = [
        Lattice(number, block.nodes, (0,) * len(block.counts)) for number, block in enumerate(grid.blocks)
    ]
    if grid.form != "volume":
        every = [
            SceneSheet(number, f"block {number}", "block", None, 0, tuple((0, n - 1) for n in block.counts))
            for number, block in enumerate(grid.blocks)
        ]
        return lattices, every
    sheets = []
    for patch in grid.outer_patches():
        axis, end = patch.place
        last = grid.blocks[patch.block].counts[axis] - 1
        ranges = patch.range(grid.face(patch.block, patch.side).shape[:-1])
        sheets.append(SceneSheet(patch.block, patch.name, patch.kind, axis, last if end else 0, ranges))
    return lattices, sheets


def _in_part(grid: Grid, layer: tuple[str, int] | None) -> tuple[list[Lattice], list[SceneSheet]]:
    """Return the patches of a volume, and layers at equal steps of i, j and k."""
    lattices, sheets = _shell(grid)
    room = (MOST_NODES - sum(math.prod(each.counts) for each in lattices)) // 3
    counts = np.array([block.counts for block in grid.blocks])
    for axis, name in enumerate("ijk"):
        last = int(counts[:, axis].max()) - 1
        size = int(np.delete(counts, axis, axis=1).prod(axis=1).sum())
        steps = np.linspace(0.0, last, max(room // size, _LAYERS) + 2)[1:-1]
        places = {round(step) for step in steps.tolist()} | (
            {layer[1]} if layer and layer[0] == name else set()
        )
        for at in sorted(places):
            for number, block in enumerate(grid.blocks):
                if at < block.counts[axis]:
                    start = [0, 0, 0]
                    start[axis] = min(at, block.counts[axis] - 2)
                    nodes = np.take(block.nodes, at, axis=axis)
                    lattices.append(Lattice(number, nodes, tuple(start), axis))
                    ranges = tuple((0, count - 1) for count in nodes.shape[:2])
                    sheets.append(SceneSheet(len(lattices) - 1, "", "slice", None, 0, ranges, name, at))
    return lattices, sheets


def _shell(grid: Grid) -> tuple[list[Lattice], list[SceneSheet]]:
    """Return the patches of a volume, each as a lattice and a sheet."""
    lattices, sheets = [], []
    for number, patch in enumerate(grid.outer_patches()):
        axis, end = patch.place
        start = [first for first, _ in patch.range(grid.face(patch.block, patch.side).shape[:-1])]
        start.insert(axis, grid.blocks[patch.block].counts[axis] - 2 if end else 0)
        lattices.append(Lattice(patch.block, grid.at(patch), tuple(start), axis))
        ranges = tuple((0, count - 1) for count in lattices[-1].counts)
        sheets.append(SceneSheet(number, patch.name, patch.kind, None, 0, ranges))
    return lattices, sheets


def _of(lattice: Lattice, values: Sequence[Floats]) -> Floats:
    cells = values[lattice.block]
    if lattice.fixed is None:
        return cells
    at: list[Any] = [slice(first, None) for first in lattice.start]
    at[lattice.fixed] = lattice.start[lattice.fixed]
    rows, columns = (count - 1 for count in lattice.counts)
    return np.asarray(cells[tuple(at)][:rows, :columns])


def _whole_numbers(planes: Sequence[Floats]) -> Any:
    """Return the rounded values (n, m) of all lattices, concatenated."""
    return np.concatenate([np.rint(plane).astype(np.int64).ravel() for plane in planes])


def _around(grid: Grid, block: int, cell: tuple[int, ...]) -> Any:
    """Return the nodes (n, m, 3), as lists, of the layer of constant k around a cell."""
    i, j, k = cell
    near = grid.blocks[block].nodes[
        max(i - _AROUND, 0) : i + _AROUND + 2, max(j - _AROUND, 0) : j + _AROUND + 2, k
    ]
    return near.tolist()


def _metric(grid: Grid, metric: Metric, values: Sequence[Floats], scale: Scale) -> dict[str, Any]:
    every = np.concatenate([cells.ravel() for cells in values])
    worst = [
        {"block": block, "at": list(cell), "value": value, "corners": corners_of(grid, block, cell).tolist()}
        | ({} if _fits(grid) else {"around": _around(grid, block, cell)})
        for block, cell, value in worst_places(values, metric)
    ]
    return {
        "name": metric.name,
        "unit": metric.unit,
        "about": metric.short,
        "low": metric.worst == "min",
        "log": scale.log,
        "min": scale.low,
        "mean": float(every.mean()),
        "max": scale.high,
        "limits": [scale.start, scale.stop],
        "histogram": histogram(every, scale),
        "worst": worst,
    }
