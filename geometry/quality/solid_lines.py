"""How grid lines run through volumes: how they grow and bend, inside blocks and across faces.

Across a face both are taken at the nodes inside it: its edges may be irregular, and no line runs through
these.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.blocks.across import across
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.families import families
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.growth import DIRECTIONS, Extreme, Growth, Tally, ratios
from meshonet.geometry.quality.lines import Lines, bends
from meshonet.geometry.threads import threads_for
from meshonet.kernels import _native


@dataclass(frozen=True)
class _Part:
    """Growth and bend along a direction of a block, inside it or across a face."""

    block: int
    axis: int
    inside: bool
    growth: Tally
    bend: Tally


def solid_lines(grid: Grid, *, percentiles: bool = True) -> Lines:
    """Return growth and bend of the lines of blocks of volume.

    The `percentiles`, inside blocks and across faces, are of values in single precision.
    """
    parts = [*_inside(grid, percentiles), *_across(grid, percentiles)]
    family = {(m.block, m.axis): k for k, members in enumerate(families(grid)) for m in members}
    walls = [(patch.name, family[patch.block, patch.place[0]]) for patch in grid.walls()]

    def leaving(names: set[str]) -> Extreme | None:
        own = {number for name, number in walls if name in names}
        return _of(part.growth for part in parts if family[part.block, part.axis] in own)

    def where(what: str, inside: bool) -> Extreme | None:
        return _of((getattr(part, what) for part in parts if part.inside is inside), kept=percentiles)

    along = (_of(part.growth for part in parts if part.axis == axis) for axis in range(3))
    return Lines(
        Growth(*along),
        leaving({name for name, _ in walls}),
        where("growth", True),
        where("growth", False),
        where("bend", True),
        where("bend", False),
        {name: growth for name, _ in walls if (growth := leaving({name}))},
    )


def _of(tallies: Iterable[Tally], *, kept: bool = False) -> Extreme | None:
    every = Tally(kept=kept)
    for tally in tallies:
        every.add_all(tally)
    return every.extreme


def _inside(grid: Grid, kept: bool) -> Iterator[_Part]:
    for number, block in enumerate(grid.blocks):
        ni = block.counts[0]
        summary, where = np.empty((ni, 3, 2, 2)), np.empty((ni, 3, 2, 3), dtype=np.int64)
        values = np.empty((3, 2, *block.counts), dtype=np.float32) if kept else None
        _native.solids_lines(block.nodes, threads_for(block.nodes[..., 0].size), summary, where, values)
        for axis, count in enumerate(block.counts):
            size = int(np.prod(block.counts)) // count * (count - 2)
            measures = [Tally(kept=kept), Tally(kept=kept)]
            inner = tuple(slice(1, -1) if each == axis else slice(None) for each in range(3))
            for m, tally in enumerate(measures):
                plane = int(summary[:, axis, m, 0].argmax())
                at = number, *(int(k) for k in where[plane, axis, m])
                high, total = float(summary[plane, axis, m, 0]), float(summary[:, axis, m, 1].sum())
                if size:
                    tally.add_summed(high, total, size, at, DIRECTIONS[axis])
                    if values is not None:
                        tally.keep(values[axis, m][inner])
            yield _Part(number, axis, True, *measures)


def _across(grid: Grid, kept: bool) -> Iterator[_Part]:
    for each in grid.connections:
        own, donor = across(grid, each, 2)
        line = np.stack([own[1], own[0], donor[1]])
        inner = [slice(1, -1) if n > 2 else slice(None) for n in line.shape[1:3]]
        line = line[:, inner[0], inner[1]]
        axis, end = PLACES[each.side]
        at = [first + (part.start or 0) for (first, _), part in zip(each.range, inner, strict=True)]
        at.insert(axis, 0 if end == 0 else grid.blocks[each.block].counts[axis] - 1)
        measures = []
        for measure in (ratios, bends):
            tally = Tally(kept=kept)
            values = np.expand_dims(measure(line)[0], axis)
            tally.add_from((each.block, *at), values, DIRECTIONS[axis])
            measures.append(tally)
        yield _Part(each.block, axis, False, *measures)
