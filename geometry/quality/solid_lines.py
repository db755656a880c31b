"""Growth and bending of the grid lines of volumes, also across connections.

Across a face both are taken at the nodes inside it: its edges may be irregular, and no line runs through
these.
"""

from collections.abc import Iterator

import numpy as np

from meshonet.geometry.blocks.across import across
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.growth import DIRECTIONS, Tally, ratios
from meshonet.geometry.quality.lines import BlockLines, Lines, bends, lines_of, part_of_values
from meshonet.geometry.threads import threads_for
from meshonet.kernels import _native


def solid_lines(grid: Grid, *, percentiles: bool = True) -> Lines:
    """Return growth and bend of the lines of blocks of volume.

    The `percentiles`, inside blocks and across faces, are of values in single precision.
    """
    parts = [*_inside(grid, percentiles), *_across(grid, percentiles)]
    return lines_of(grid, parts, along=False, places=percentiles)


def _inside(grid: Grid, kept: bool) -> Iterator[BlockLines]:
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
            yield BlockLines(number, axis, True, *measures)


def _across(grid: Grid, kept: bool) -> Iterator[BlockLines]:
    for each in grid.connections:
        own, donor = across(grid, each, 2)
        line = np.stack([own[1], own[0], donor[1]])
        inner = [slice(1, -1) if n > 2 else slice(None) for n in line.shape[1:3]]
        line = line[:, inner[0], inner[1]]
        axis, end = PLACES[each.side]
        at = [first + (part.start or 0) for (first, _), part in zip(each.range, inner, strict=True)]
        at.insert(axis, 0 if end == 0 else grid.blocks[each.block].counts[axis] - 1)
        values = (np.expand_dims(measure(line)[0], axis) for measure in (ratios, bends))
        yield part_of_values((each.block, *at), axis, False, values, kept=kept)
