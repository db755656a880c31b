"""Where blocks touch each other or themselves, found by the places of their nodes; here those in the plane.

::

    +--+--+--+--+
    |  block 0  |      Every cell at a boundary is a directed edge, the block on its left. Two blocks that
    +--+--+-----+      touch run along their interface in opposite directions; blocks that only lie on each
    |  |  |            other, copies for instance, run the same way and are not joined. A part of a side may
    +--+--+            be joined, and a side to itself, as the wake of a C grid is.
    block 1

Blocks in space: `meshonet.geometry.blocks.meeting_sides`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import PLACES, Block, Range
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.rounding import rounding
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import Indices

TOLERANCE = 1e-6
"""Nodes are the same when they are no farther apart than this, in lengths of the shorter of two edges."""
AROUND: tuple[tuple[Side, int], ...] = (("south", 1), ("east", 1), ("north", -1), ("west", -1))
"""Sides in counter-clockwise order, and whether that follows their nodes."""
_DIRECTION = np.array([math.cos(0.7), math.sin(0.7)])
"""Nodes are sorted along this direction, along which few grids have many of equal place."""

_MOST = 0.25
"""Nodes farther apart than this part of an edge are different, however coarsely they were rounded."""
Stretch: TypeAlias = tuple[int, Side, int, int]
"""Block, side, first and last node of a part of its boundary."""
Part: TypeAlias = tuple[int, Side, Range]
"""Block, side, and first and last node along each of its directions, of a part of the boundary."""


def find_connections(
    blocks: Sequence[Block], tolerance: float = TOLERANCE, *, without: Iterable[Stretch | Part] = ()
) -> tuple[Connection, ...]:
    """Return the connections of right-handed `blocks`, sorted by block and side.

    Nodes are the same when they are no farther apart than `tolerance` edges, or than the digits tell that
    their coordinates were rounded to (`meshonet.geometry.blocks.rounding`). Nodes of a connection need not be
    equal yet: `with_equal_nodes` (`meshonet.geometry.blocks.equal_nodes`) makes them. `without` has stretches
    that are known to be no interface. Where more than two sides lie on each other, a block is joined to
    itself first, then one to the next.

    Raises InputError: blocks in the plane and in space mixed.
    """
    if blocks and blocks[0].nodes.shape[-1] == 3:
        from meshonet.geometry.blocks.meeting_sides import meeting_sides

        parts = [each if len(each) == 3 else (*each[:2], (each[2:],)) for each in without]
        return tuple(sorted(meeting_sides(blocks, tolerance, parts), key=order))
    edges = _edges(blocks, [each for each in without if len(each) == 4])
    free = np.ones(len(edges.start), dtype=bool)
    starts = np.searchsorted(edges.block, np.arange(len(blocks) + 1))
    connections = []
    for first, last in [*pairwise(starts.tolist()), (0, len(free))]:  # each block by itself, then all
        among = first + np.flatnonzero(free[first:last])
        runs = _runs(edges, *_pairs(edges, among, tolerance))
        for run in sorted(runs, key=_Run.rank):
            for start, stop in run.parts(free):
                own, donor = run.own[start:stop], run.donor[start:stop]
                free[own] = free[donor] = False
                connections.append(_connection(edges, own, donor))
    return tuple(sorted(connections, key=order))


def order(connection: Connection) -> tuple[int, int, Range]:
    """Return what connections are sorted by: block, side and nodes."""
    return connection.block, list(PLACES).index(connection.side), connection.range


@dataclass(frozen=True)
class _Edges:
    """Boundary edges of all blocks, counter-clockwise, one side after the other."""

    start: Floats
    end: Floats
    block: Indices
    side: Indices
    cell: Indices
    slack: Floats
    """How far a node may be from where it was meant."""

    def reach(self, tolerance: float) -> Floats:
        """Return how far nodes that are the same may be apart."""
        length = np.hypot(*(self.end - self.start).T)
        return np.minimum(np.maximum(tolerance * length, self.slack), _MOST * length)


def _edges(blocks: Sequence[Block], without: Iterable[Stretch]) -> _Edges:
    known = list(without)
    lines, blocks_of, sides, cells, used = [], [], [], [], []
    for number, each in enumerate(blocks):
        if each.nodes.shape[2:] != (2,):
            raise InputError(f"block {number} is not planar", "find connections of planar blocks")
        for turn, (side, way) in enumerate(AROUND):
            face = each.face(side)
            count = len(face) - 1
            keep = np.ones(count, dtype=bool)
            for _, _, first, last in (s for s in known if s[:2] == (number, side)):
                keep[first:last] = False
            lines.append(np.stack([face[:-1], face[1:]], axis=1)[::way, ::way])
            cells.append(np.arange(count)[::way])
            used.append(keep[::way])
            blocks_of.append(np.full(count, number))
            sides.append(np.full(count, turn))
    line, keep = np.concatenate(lines), np.concatenate(used)
    keep &= (line[:, 0] != line[:, 1]).any(axis=1)  # a side may be a point
    line = line[keep]
    about = np.abs(line).max(axis=(1, 2))
    digits = rounding(line.reshape(-1))
    block, place, cell = (np.concatenate(parts)[keep] for parts in (blocks_of, sides, cells))
    return _Edges(line[:, 0], line[:, 1], block, place, cell, 2.0 * digits(about))


def _pairs(edges: _Edges, among: Indices, tolerance: float) -> tuple[Indices, Indices]:
    """Return pairs of edges, the first one of the lower number, that join the same nodes in opposite ways."""
    reach = edges.reach(tolerance)
    place = product(0.5 * (edges.start[among] + edges.end[among]), _DIRECTION)
    row = among[np.argsort(place, kind="stable")]
    ordered = np.sort(place, kind="stable")
    stop = np.searchsorted(ordered, ordered + reach[row], side="right")
    count = np.maximum(stop - np.arange(len(row)) - 1, 0)
    first = np.repeat(np.arange(len(row)), count)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count)
    a, b = row[first], row[second]
    near = np.minimum(reach[a], reach[b])
    same = np.hypot(*(edges.start[a] - edges.end[b]).T) <= near
    same &= np.hypot(*(edges.end[a] - edges.start[b]).T) <= near
    a, b = a[same], b[same]
    low, high = np.minimum(a, b), np.maximum(a, b)
    sort = np.lexsort([high, low])
    return low[sort], high[sort]


class _Run(NamedTuple):
    """Neighbouring edges of one side and the edges of another one that they lie on, the latter backwards."""

    own: Indices
    donor: Indices

    def rank(self) -> tuple[int, int, int]:
        """Return what decides between runs that claim the same edges."""
        return -len(self.own), int(self.own[0]), int(self.donor[0])

    def parts(self, free: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> Iterator[tuple[int, int]]:
        """Yield the first place and that behind the last one of each part of which no edge is taken."""
        open_ = free[self.own] & free[self.donor]
        ends = np.flatnonzero(np.diff(np.concatenate([[False], open_, [False]]).astype(np.int8)))
        for first, last in ends.reshape(-1, 2).tolist():
            yield int(first), int(last)


def _runs(edges: _Edges, own: Indices, donor: Indices) -> Iterator[_Run]:
    """Yield pairs joined to runs along which own edges ascend and the donor's descend."""
    step = {(int(a), int(b)): k for k, (a, b) in enumerate(zip(own, donor, strict=True))}
    seen = np.zeros(len(own), dtype=bool)
    for k in range(len(own)):
        if seen[k]:
            continue
        at, run = k, []
        while at >= 0 and not seen[at]:
            seen[at] = True
            run.append(at)
            a, b = int(own[at]), int(donor[at])
            follows = step.get((a + 1, b - 1), -1)
            if follows < 0 or not _adjacent(edges, a, a + 1) or not _adjacent(edges, b - 1, b):
                break
            at = follows
        yield _Run(own[run], donor[run])


def _adjacent(edges: _Edges, a: int, b: int) -> bool:
    """Say whether two edges of following numbers are neighbours on one side of a block."""
    return bool(
        edges.block[a] == edges.block[b]
        and edges.side[a] == edges.side[b]
        and abs(edges.cell[a] - edges.cell[b]) == 1
    )


def _connection(edges: _Edges, own: Indices, donor: Indices) -> Connection:
    """Return the connection of two runs of edges, the side that comes first in `PLACES` of a block as own."""
    ends = []
    for run in (own, donor):
        side, _ = AROUND[edges.side[run[0]]]
        cells = edges.cell[run]
        ends.append((int(edges.block[run[0]]), side, ((int(cells.min()), int(cells.max()) + 1),)))
    ways = AROUND[edges.side[own[0]]][1] * AROUND[edges.side[donor[0]]][1]
    first, second = sorted(ends, key=lambda end: (end[0], list(PLACES).index(end[1]), end[2]))
    return Connection(*first, *second, (-ways,))
