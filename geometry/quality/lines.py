"""How grid lines run through blocks of two directions: how they grow and bend, inside and across sides.

The growth at a node is that of `meshonet.geometry.quality.growth`; the bend is the angle in degrees by which
a line turns there, 0 where it is straight. Across a side both are taken at its nodes, but for irregular ones,
through which no line runs.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.across import across
from meshonet.geometry.blocks.block import PLACES, face_of
from meshonet.geometry.blocks.families import families
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import Vertices
from meshonet.geometry.elementary import arctan2
from meshonet.geometry.polygon.corners import angle_between
from meshonet.geometry.quality.growth import DIRECTIONS, Extreme, Growth, Tally, ratios


@dataclass(frozen=True)
class Lines:
    """Growth and bend at the nodes of the lines, the greatest at (block, i, j); None without any.

    `growth` is that along both directions of blocks, those across a side with the direction that ends there;
    `leaving` is the growth along the lines that leave walls, through all blocks that they run through;
    `by_wall` that of each wall, by name.
    """

    growth: Growth
    leaving: Extreme | None
    growth_inside: Extreme | None
    growth_across: Extreme | None
    bend_inside: Extreme | None
    bend_across: Extreme | None
    by_wall: Mapping[str, Extreme]


@dataclass(frozen=True)
class _Part:
    """Lines along a direction of a block, inside it or across a side: (m, n) nodes from (i, j) on."""

    block: int
    axis: int
    inside: bool
    i: int
    j: int
    growth: Floats
    bend: Floats


def lines(grid: Grid, nodes: Vertices) -> Lines:
    """Return growth and bend of the lines of planar blocks or surface patches with vertices `nodes`."""
    parts = [*_inside(grid), *_across(grid, nodes)]
    family = {(m.block, m.axis): k for k, members in enumerate(families(grid)) for m in members}
    walls = [(patch.name, family[patch.block, patch.place[0]]) for patch in grid.walls()]
    xi, eta = ([part for part in parts if part.axis == axis] for axis in (0, 1))

    def leaving(names: set[str]) -> Extreme | None:
        own = {number for name, number in walls if name in names}
        return _of([part for part in parts if family[part.block, part.axis] in own], "growth")

    within, beyond = ([part for part in parts if part.inside == inside] for inside in (True, False))
    return Lines(
        Growth(_of(xi, "growth"), _of(eta, "growth")),
        leaving({name for name, _ in walls}),
        _of(within, "growth"),
        _of(beyond, "growth"),
        _of(within, "bend"),
        _of(beyond, "bend"),
        {name: growth for name, _ in walls if (growth := leaving({name}))},
    )


def _of(parts: list[_Part], what: str) -> Extreme | None:
    tally = Tally(kept=True)
    for part in parts:
        tally.add(part.i, part.j, getattr(part, what), part.block, DIRECTIONS[part.axis])
    return tally.extreme


def _inside(grid: Grid) -> Iterator[_Part]:
    for number, block in enumerate(grid.blocks):
        for axis in (0, 1):
            nodes = np.moveaxis(block.nodes, axis, 0)
            values = (np.moveaxis(each(nodes), 0, axis) for each in (ratios, bends))
            yield _Part(number, axis, True, 1 - axis, axis, *values)


def _across(grid: Grid, nodes: Vertices) -> Iterator[_Part]:
    """Yield the lines across each connection, an unbroken stretch of regular nodes at a time."""
    for each in grid.connections:
        own, donor = across(grid, each, 2)
        line = np.stack([own[1], own[0], donor[1]])
        growth, bend = ratios(line)[0], bends(line)[0]
        start, stop = each.range[0]
        regular = nodes.regular[face_of(nodes.numbers[each.block], each.side)[start : stop + 1]]
        axis, end = PLACES[each.side]
        for first, last in _runs(regular):
            at = [start + first] * 2
            at[axis] = 0 if end == 0 else grid.blocks[each.block].counts[axis] - 1
            values = (np.expand_dims(value[first:last], axis) for value in (growth, bend))
            yield _Part(each.block, axis, False, at[0], at[1], *values)


def _runs(true: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> Iterator[tuple[int, int]]:
    """Yield first and one behind the last of each stretch of true values."""
    steps = np.diff(np.concatenate([[False], true, [False]]).astype(np.int8))
    yield from zip(np.flatnonzero(steps == 1).tolist(), np.flatnonzero(steps == -1).tolist(), strict=True)


def bends(nodes: Floats) -> Floats:
    """Return the angles (m-2, ...) in degrees by which lines along the first axis (m, ..., d) turn."""
    step = np.diff(nodes, axis=0)
    before, after = step[:-1], step[1:]
    if nodes.shape[-1] == 2:
        angle = np.abs(angle_between(before.reshape(-1, 2), after.reshape(-1, 2))).reshape(before.shape[:-1])
    else:
        angle = arctan2(norms(np.cross(before, after)), (before * after).sum(axis=-1))
    return np.degrees(angle)
