"""Growth and bend (turn in degrees) of grid lines, also across connections.

Across a side they are taken at its nodes but irregular ones, across a face of a volume at inner nodes.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.across import across
from meshonet.geometry.blocks.block import PLACES, face_of
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.families import families
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import Vertices, vertices
from meshonet.geometry.polygon.corners import angle_between
from meshonet.geometry.quality.growth import DIRECTIONS, Extreme, Growth, Tally, ratios
from meshonet.geometry.threads import over_blocks, threads_for
from meshonet.kernels import _native


@dataclass(frozen=True)
class Lines:
    """Largest and mean growth ratios and bends (turning angles in degrees) of the grid lines of a grid.

    `growth` is along each direction of the blocks. Fields that end in ``_inside`` are at nodes inside blocks,
    those in ``_across`` at nodes on sides between blocks. `leaving` is the growth along lines that start at
    walls, continued from block to block; `by_wall` has it for each wall alone. Fields without nodes are None.
    """

    growth: Growth
    leaving: Extreme | None
    growth_inside: Extreme | None
    growth_across: Extreme | None
    bend_inside: Extreme | None
    bend_across: Extreme | None
    by_wall: Mapping[str, Extreme]


@dataclass(frozen=True)
class BlockLines:
    """Growth ratios and bends (turning angles) of grid lines along `axis`, inside a block or at its sides."""

    block: int
    axis: int
    inside: bool
    growth: Tally
    bend: Tally


def lines(grid: Grid, nodes: Vertices, *, all_measures: bool = True) -> Lines:
    """Return growth ratios and turning angles on the grid lines of planar blocks or surface patches.

    `nodes` are the vertices of the grid. Without `all_measures`, turning angles and percentiles are None.
    """
    measures = (ratios, bends) if all_measures else (ratios,)
    parts = [*_inside(grid, measures), *_across(grid, nodes, measures)]
    return lines_of(grid, parts, along=all_measures, places=all_measures)


def lines_of(grid: Grid, parts: list[BlockLines], *, along: bool = True, places: bool = True) -> Lines:
    """Return growth ratios and turning angles on all grid lines in `parts`.

    Statistics along each block direction, and along lines from each wall, include percentiles if `along` is
    set. Statistics at nodes inside blocks, and at nodes on sides, include percentiles if `places` is set.
    """
    family = {(m.block, m.axis): k for k, members in enumerate(families(grid)) for m in members}
    walls = [(patch.name, family[patch.block, patch.place[0]]) for patch in grid.walls()]

    def leaving(names: set[str]) -> Extreme | None:
        own = {number for name, number in walls if name in names}
        return _of((part.growth for part in parts if family[part.block, part.axis] in own), kept=along)

    def where(what: str, inside: bool) -> Extreme | None:
        return _of((getattr(part, what) for part in parts if part.inside is inside), kept=places)

    axes = range(len(grid.blocks[0].counts))
    directions = (_of((p.growth for p in parts if p.axis == axis), kept=along) for axis in axes)
    return Lines(
        Growth(*directions),
        leaving({name for name, _ in walls}),
        where("growth", True),
        where("growth", False),
        where("bend", True),
        where("bend", False),
        {name: growth for name, _ in walls if (growth := leaving({name}))},
    )


def _of(tallies: Iterable[Tally], *, kept: bool) -> Extreme | None:
    every = Tally(kept=kept)
    for tally in tallies:
        every.add_all(tally)
    return every.extreme


def part_of_values(
    place: tuple[int, ...], axis: int, inside: bool, values: Iterable[Floats], *, kept: bool = True
) -> BlockLines:
    """Return statistics of growth ratios, and of turning angles if they are given, at an array of nodes.

    `values` yields the ratios (m, n[, l]) on grid lines along `axis`, then the angles. `place` is the first
    node: block, i, j[, k]. `inside`: nodes are inside the block, not on a side. `kept`: include percentiles.
    """
    tallies = Tally(kept=kept), Tally(kept=kept)
    for tally, each in zip(tallies, values, strict=False):
        tally.add(place, each, DIRECTIONS[axis])
    return BlockLines(place[0], axis, inside, *tallies)


def _inside(grid: Grid, measures: Sequence[Callable[[Floats], Floats]]) -> Iterator[BlockLines]:
    for number, block in enumerate(grid.blocks):
        for axis in (0, 1):
            nodes = np.moveaxis(block.nodes, axis, 0)
            values = (np.moveaxis(each(nodes), 0, axis) for each in measures)
            yield part_of_values((number, 1 - axis, axis), axis, True, values)


def _across(
    grid: Grid, nodes: Vertices, measures: Sequence[Callable[[Floats], Floats]]
) -> Iterator[BlockLines]:
    """Yield the lines across each connection, by stretches of regular nodes."""
    for each in grid.connections:
        own, donor = across(grid, each, 2)
        line = np.stack([own[1], own[0], donor[1]])
        measured = [each(line)[0] for each in measures]
        start, stop = each.range[0]
        regular = nodes.regular[face_of(nodes.numbers[each.block], each.side)[start : stop + 1]]
        axis, end = PLACES[each.side]
        steps = np.diff(np.concatenate([[False], regular, [False]]).astype(np.int8))
        ends = zip(np.flatnonzero(steps == 1).tolist(), np.flatnonzero(steps == -1).tolist(), strict=True)
        for first, last in ends:
            at = [start + first] * 2
            at[axis] = 0 if end == 0 else grid.blocks[each.block].counts[axis] - 1
            values = (np.expand_dims(value[first:last], axis) for value in measured)
            yield part_of_values((each.block, *at), axis, False, values)


def bends(nodes: Floats) -> Floats:
    """Return the angles (m-2, ...), in degrees, by which lines along axis 0 of `nodes` (m, ..., d) turn."""
    step = np.diff(nodes, axis=0)
    return np.degrees(np.abs(angle_between(step[:-1], step[1:])))


def solid_lines(grid: Grid, *, percentiles: bool = True) -> Lines:
    """Return growth and turning of grid lines of volumes; percentiles are computed in single precision."""
    numbers, nodes = range(len(grid.blocks)), [block.nodes[..., 0].size for block in grid.blocks]
    inside = over_blocks(lambda number: _solid_inside(grid, number, percentiles), numbers, nodes)
    nodes = [2 * math.prod(stop - start + 1 for start, stop in each.range) for each in grid.connections]
    beyond = over_blocks(lambda each: _solid_across(grid, each, percentiles), grid.connections, nodes)
    return lines_of(grid, [*chain.from_iterable(inside), *beyond], along=False, places=percentiles)


def _solid_inside(grid: Grid, number: int, kept: bool) -> list[BlockLines]:
    block = grid.blocks[number]
    ni = block.counts[0]
    summary, where = np.empty((ni, 3, 2, 2)), np.empty((ni, 3, 2, 3), dtype=np.int64)
    values = np.empty((3, 2, *block.counts), dtype=np.float32) if kept else None
    _native.solids_lines(block.nodes, threads_for(block.nodes[..., 0].size), summary, where, values)
    parts = []
    for axis, count in enumerate(block.counts):
        size = int(np.prod(block.counts)) // count * (count - 2)
        measures = [Tally(kept=kept), Tally(kept=kept)]
        inner = tuple(slice(1, -1) if each == axis else slice(None) for each in range(3))
        for m, tally in enumerate(measures):
            plane = int(summary[:, axis, m, 0].argmax())
            at = number, *(int(k) for k in where[plane, axis, m])
            high, total = float(summary[plane, axis, m, 0]), float(summary[:, axis, m, 1].sum())
            if size:
                own = [] if values is None else [values[axis, m][inner]]
                tally.add_summed(high, total, size, at, DIRECTIONS[axis], own)
        parts.append(BlockLines(number, axis, True, *measures))
    return parts


def _solid_across(grid: Grid, each: Connection, kept: bool) -> BlockLines:
    own, donor = across(grid, each, 2)
    line = np.stack([own[1], own[0], donor[1]])
    inner = [slice(1, -1) if n > 2 else slice(None) for n in line.shape[1:3]]
    line = line[:, inner[0], inner[1]]
    axis, end = PLACES[each.side]
    at = [first + (part.start or 0) for (first, _), part in zip(each.range, inner, strict=True)]
    at.insert(axis, 0 if end == 0 else grid.blocks[each.block].counts[axis] - 1)
    values = (np.expand_dims(measure(line)[0], axis) for measure in (ratios, bends))
    return part_of_values((each.block, *at), axis, False, values, kept=kept)


def growth_of_cells(grid: Grid) -> list[Floats]:
    """Return, for each block, the greatest growth ratio (ni-1, nj-1[, nk-1]) at the corners of each cell."""
    at_nodes = [np.ones(block.counts) for block in grid.blocks]
    for block, values in zip(grid.blocks, at_nodes, strict=True):
        for axis in range(values.ndim):
            inner = np.moveaxis(values, axis, 0)[1:-1]
            np.maximum(inner, _growth(np.moveaxis(block.nodes, axis, 0)), out=inner)
    regular = None if grid.form == "volume" else vertices(grid)
    for each in (way for connection in grid.connections for way in (connection, connection.reversed())):
        own, donor = across(grid, each, 2)
        part = tuple(slice(start, stop + 1) for start, stop in each.range)
        values = face_of(at_nodes[each.block], each.side)[part]
        growth = _growth(np.stack([own[1], own[0], donor[1]]))[0]
        if regular is not None:
            growth[~face_of(regular.regular[regular.numbers[each.block]], each.side)[part]] = 1.0
        np.maximum(values, growth, out=values)
    for number, values in enumerate(at_nodes):
        for axis in range(values.ndim):
            nodes = np.moveaxis(values, axis, 0)
            values = np.moveaxis(np.maximum(nodes[:-1], nodes[1:]), 0, axis)
        at_nodes[number] = values
    return at_nodes


def _growth(nodes: Floats) -> Floats:
    """Return the growth (m-2, ...) along the first axis; 1 within lines of length 0."""
    length = norms(np.diff(nodes, axis=0))
    return np.where(length[:-1] + length[1:] > 0.0, ratios(nodes), 1.0)
