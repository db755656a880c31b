"""Figures of a multi-block grid other than cell metrics."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats, percentiles_of, ring_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import shared_nodes
from meshonet.geometry.blocks.vertices import Vertices, vertices
from meshonet.geometry.polygon.corners import angle_between
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.lines import Lines, lines, solid_lines
from meshonet.geometry.summary import Quality


@dataclass(frozen=True)
class BlockCounts:
    """Blocks and irregular vertices of a grid.

    `sizes` are the node counts of each block. `irregular` lists the inner nodes (block, i, j) at which more
    or fewer than four cells meet, each with its number of cells. For volumes, `irregular` is None.
    """

    sizes: tuple[tuple[int, ...], ...]
    irregular: tuple[tuple[tuple[int, int, int], int], ...] | None


@dataclass(frozen=True)
class BlockFigures(BlockCounts):
    """Counts, angles and grid lines of a multi-block grid; `nodes` is the number of distinct nodes.

    `deviation` is the difference of corner angles from 90 degrees. At a corner of a volume three angles meet;
    the largest difference counts. The mean is over all corners. The 99th percentile is over all cells; a
    cell counts with the largest difference at its corners.
    """

    nodes: int
    interfaces: int
    deviation: Extreme
    lines: Lines

    def as_dict(self) -> dict[str, Any]:
        """Return the figures as a dict that JSON can hold."""
        facts: dict[str, Any] = {
            "blocks": len(self.sizes),
            "interfaces": self.interfaces,
            "nodes": self.nodes,
            "sizes": [list(size) for size in self.sizes],
        }
        if self.irregular is not None:
            places = [{"at": list(at), "cells": cells} for at, cells in self.irregular]
            facts |= {"irregular": len(self.irregular), "irregular_vertices": places}
        worst = self.deviation
        return facts | {
            "deviation": {"mean": worst.mean, "p99": worst.p99, "max": worst.max, "at": list(worst.at)},
            "lines": {name: extreme_dict(getattr(self.lines, name)) for name in LINES},
        }


LINES = ("growth_inside", "growth_across", "bend_inside", "bend_across")  # fields of `Lines` in reports


def block_figures(grid: Grid, quality: Quality | None = None, known: Lines | None = None) -> BlockFigures:
    """Return node counts, corner angles and growth along grid lines of a multi-block grid.

    `quality` (of a volume) and `known` (growth and bends of grid lines) may be given if they have been
    measured. With a `quality` that has no percentiles, the result has none.
    """
    if grid.form == "volume":
        from meshonet.geometry.quality.volumes import measure_volumes

        quality = quality or measure_volumes(grid, percentiles=True)
        worst = quality["skewness"]  # deviation over 90 degrees
        p99 = None if worst.p99 is None else 90.0 * worst.p99
        angles = Extreme(90.0 * worst.max, quality["deviation"].mean, worst.worst, p99)
        sizes = tuple(block.counts for block in grid.blocks)
        numbers = shared_nodes(sizes, grid.connections, periodic=True)
        count = 1 + max(int(number.max()) for number in numbers)
        if not known or p99 is not None:
            known = solid_lines(grid, percentiles=p99 is not None)
        return BlockFigures(sizes, None, count, len(grid.connections), angles, known)
    nodes = vertices(grid)
    counts, count = block_counts(grid, nodes), len(nodes.valence)
    more = count, len(grid.connections), deviation(grid), known or lines(grid, nodes)
    return BlockFigures(counts.sizes, counts.irregular, *more)


def block_counts(grid: Grid, nodes: Vertices | None = None) -> BlockCounts:
    """Return blocks and irregular vertices of a grid; `nodes` is the result of `vertices`, or None."""
    sizes = tuple(block.counts for block in grid.blocks)
    if grid.form == "volume":
        return BlockCounts(sizes, None)
    nodes = nodes or vertices(grid)
    irregular = [(nodes.place(int(node)), int(nodes.valence[node])) for node in nodes.irregular]
    return BlockCounts(sizes, tuple(irregular))


def extreme_dict(extreme: Extreme | None) -> dict[str, Any] | None:
    """Return an extreme (maximum and mean of a quantity) as a dict that JSON can hold."""
    if extreme is None:
        return None
    facts = {"max": extreme.max, "mean": extreme.mean, "at": list(extreme.at)}
    return facts if extreme.p99 is None else facts | {"p99": extreme.p99}


def deviation(grid: Grid) -> Extreme:
    """Return how far the corner angles of planar blocks or patches deviate from 90 degrees.

    Angles are from 0 to 360 degrees, so that deviations reach 270.
    """
    every = [corner_deviations(block.nodes) for block in grid.blocks]
    worst = [corners.max(axis=0) for corners in every]
    block = int(np.argmax([cells.max() for cells in worst]))
    i, j = divmod(int(worst[block].argmax()), worst[block].shape[1])
    corners = sum(values.size for values in every)
    return Extreme(
        mean=float(sum(values.sum() for values in every)) / corners,
        p99=percentiles_of(np.concatenate([cells.ravel() for cells in worst]), (99,))[0],
        max=float(worst[block].max()),
        at=(block, i, j),
    )


def corner_deviations(nodes: Floats) -> Floats:
    """Return by how many degrees (4, ni-1, nj-1) cell corners of `nodes` (ni, nj, 2 or 3) differ from 90."""
    ring = ring_of(nodes)
    ahead = np.roll(ring, -1, axis=0) - ring
    angle = angle_between(ahead, -np.roll(ahead, 1, axis=0))
    return np.asarray(np.abs(np.degrees(angle) % 360.0 - 90.0))
