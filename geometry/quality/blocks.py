"""Figures of a grid of many blocks beside the metrics of its cells."""

from dataclasses import dataclass
from typing import Any

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import node_count
from meshonet.geometry.blocks.vertices import Vertices, vertices
from meshonet.geometry.quality.deviation import Deviation, deviation, solid_deviation
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.lines import Lines, lines, solid_lines
from meshonet.geometry.summary import Quality


@dataclass(frozen=True)
class BlockCounts:
    """Blocks and irregular vertices of a grid.

    `sizes` are the nodes of each block, `irregular` the inner vertices (block, i, j) where other than four
    cells meet, each with the cells that meet there; None in volumes.
    """

    sizes: tuple[tuple[int, ...], ...]
    irregular: tuple[tuple[tuple[int, int, int], int], ...] | None


@dataclass(frozen=True)
class BlockFigures(BlockCounts):
    """Counts, angles and lines of a grid of blocks; `nodes` are those of all blocks without doubles."""

    nodes: int
    interfaces: int
    deviation: Deviation
    lines: Lines

    def as_dict(self) -> dict[str, Any]:
        """Return it as what JSON can hold."""
        facts: dict[str, Any] = {
            "blocks": len(self.sizes),
            "interfaces": self.interfaces,
            "nodes": self.nodes,
            "sizes": [list(size) for size in self.sizes],
        }
        if self.irregular is not None:
            places = [{"at": list(at), "cells": cells} for at, cells in self.irregular]
            facts |= {"irregular": len(self.irregular), "irregular_vertices": places}
        return facts | {
            "deviation": vars(self.deviation) | {"at": list(self.deviation.at)},
            "lines": {name: extreme_dict(getattr(self.lines, name)) for name in LINES},
        }


LINES = ("growth_inside", "growth_across", "bend_inside", "bend_across")
"""Fields of `Lines` that are reported."""


def block_figures(grid: Grid, quality: Quality | None = None) -> BlockFigures:
    """Return the figures of a grid of blocks; of volumes, their `quality` is measured unless it is known.

    Lines of volumes have percentiles where their quality has.
    """
    if grid.form == "volume":
        from meshonet.geometry.quality.volumes import measure_volumes

        angles = solid_deviation(quality or measure_volumes(grid, percentiles=True))
        sizes = tuple(block.counts for block in grid.blocks)
        count = node_count(sizes, grid.connections)
        run = solid_lines(grid, percentiles=angles.p99 is not None)
        return BlockFigures(sizes, None, count, len(grid.connections), angles, run)
    nodes = vertices(grid)
    counts, count = block_counts(grid, nodes), len(nodes.valence)
    more = count, len(grid.connections), deviation(grid), lines(grid, nodes)
    return BlockFigures(counts.sizes, counts.irregular, *more)


def block_counts(grid: Grid, nodes: Vertices | None = None) -> BlockCounts:
    """Return the blocks and irregular vertices of a grid; its vertices are `nodes`, found unless given."""
    sizes = tuple(block.counts for block in grid.blocks)
    if grid.form == "volume":
        return BlockCounts(sizes, None)
    nodes = nodes or vertices(grid)
    irregular = [(nodes.place(int(node)), int(nodes.valence[node])) for node in nodes.irregular]
    return BlockCounts(sizes, tuple(irregular))


def extreme_dict(extreme: Extreme | None) -> dict[str, Any] | None:
    """Return an extreme as what JSON can hold."""
    if extreme is None:
        return None
    facts = {"max": extreme.max, "mean": extreme.mean, "at": list(extreme.at)}
    return facts if extreme.p99 is None else facts | {"p99": extreme.p99}
