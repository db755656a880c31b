"""Where planar blocks touch each other or themselves, found by the places of their nodes.

::

    +--+--+--+--+
    |  block 0  |      Every cell at a boundary is a directed edge, the block on its left. Two blocks that
    +--+--+-----+      touch run along their interface in opposite directions; blocks that only lie on each
    |  |  |            other, copies for instance, run the same way and are not joined. A part of a side may
    +--+--+            be joined, and a side to itself, as the wake of a C grid is.
    block 1
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import PLACES, Block, face_of
from meshonet.geometry.blocks.connection import Connection, Motion
from meshonet.geometry.blocks.rounding import rounding
from meshonet.geometry.blocks.shared_nodes import shared_nodes
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import Indices

TOLERANCE = 1e-6
"""Nodes are the same when they are no farther apart than this, in lengths of the shorter of two edges."""
AROUND: tuple[tuple[Side, int], ...] = (("south", 1), ("east", 1), ("north", -1), ("west", -1))
"""Sides in counter-clockwise order, and whether that follows their nodes."""
_DIRECTION = np.array([np.cos(0.7), np.sin(0.7)])
"""Nodes are sorted along this direction, along which few grids have many of equal place."""

_MOST = 0.25
"""Nodes farther apart than this part of an edge are different, however coarsely they were rounded."""
_PASSES = 9
"""Periodic sides that end on other ones need one more pass each."""

Stretch: TypeAlias = tuple[int, Side, int, int]
"""Block, side, first and last node of a part of its boundary."""


def find_connections(
    blocks: Sequence[Block], tolerance: float = TOLERANCE, *, without: Iterable[Stretch] = ()
) -> tuple[Connection, ...]:
    """Return the connections of right-handed planar `blocks`, sorted by block and side.

    Nodes are the same when they are no farther apart than `tolerance` edges, or than the digits tell that
    their coordinates were rounded to (`meshonet.geometry.blocks.rounding`). Nodes of a connection need not be
    equal yet: `with_equal_nodes` makes them. `without` says which stretches are known to be no interface.
    Where more than two sides lie on each other, a block is joined to itself first, then the first to the next.

    Raises InputError: a block that is not planar.
    """
    edges = _edges(blocks, without)
    own, donor = _pairs(edges, tolerance)
    free = np.ones(len(edges.start), dtype=bool)
    found = []
    for run in sorted(_runs(edges, own, donor), key=lambda run: run.rank(edges)):
        for first, last in run.parts(free):
            free[run.own[first:last]] = free[run.donor[first:last]] = False
            found.append(_connection(edges, run.own[first:last], run.donor[first:last]))
    return tuple(sorted(found, key=order))


def order(connection: Connection) -> tuple[int, int, int]:
    """Return what connections are sorted by: block, side and first node."""
    return connection.block, list(PLACES).index(connection.side), connection.range[0][0]


def with_equal_nodes(blocks: Sequence[Block], connections: Sequence[Connection]) -> tuple[Block, ...]:
    """Return `blocks` with the nodes that `connections` join made equal, bitwise.

    Joined nodes become the first of them; those of the second of two periodic sides the first ones moved.
    """
    numbers = shared_nodes([block.counts for block in blocks], connections)
    shared = np.concatenate([block.nodes.reshape(-1, block.nodes.shape[-1]) for block in blocks])
    _, first = np.unique(np.concatenate([number.ravel() for number in numbers]), return_index=True)
    shared = shared[first]

    def face(block: int, side: Side) -> Indices:
        return np.asarray(face_of(numbers[block], side)[..., None])

    periodic = [(each, *replace(each, transform=None).nodes(face)) for each in connections if each.transform]
    for _ in range(_PASSES if periodic else 0):
        before = shared.copy()
        for each, own, donor in periodic:
            move: Motion = each.transform or Motion()
            shared[donor[..., 0]] = move(shared[own[..., 0]])
        if np.array_equal(shared, before):
            break
    return tuple(Block(shared[number], finite=True) for number in numbers)


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

    @property
    def length(self) -> Floats:
        return np.hypot(*(self.end - self.start).T)


def _edges(blocks: Sequence[Block], without: Iterable[Stretch]) -> _Edges:
    known = list(without)
    lines, blocks_of, sides, cells, used = [], [], [], [], []
    for number, block in enumerate(blocks):
        if block.nodes.shape[2:] != (2,):
            raise InputError(f"block {number} is not planar", "find connections of planar blocks")
        for place, (side, way) in enumerate(AROUND):
            face = block.face(side)
            cell = np.arange(len(face) - 1)
            keep = np.ones(len(cell), dtype=bool)
            for _, _, first, last in (s for s in known if s[:2] == (number, side)):
                keep[first:last] = False
            lines.append(np.stack([face[:-1], face[1:]], axis=1)[::way, ::way])
            cells.append(cell[::way])
            used.append(keep[::way])
            blocks_of.append(np.full(len(cell), number))
            sides.append(np.full(len(cell), place))
    line, keep = np.concatenate(lines), np.concatenate(used)
    keep &= (line[:, 0] != line[:, 1]).any(axis=1)  # a side may be a point
    line = line[keep]
    about = np.abs(line).max(axis=(1, 2))
    digits = rounding(line.reshape(-1))
    block_of, side, cell = (np.concatenate(parts)[keep] for parts in (blocks_of, sides, cells))
    return _Edges(line[:, 0], line[:, 1], block_of, side, cell, 2.0 * digits(about))


def _pairs(edges: _Edges, tolerance: float) -> tuple[Indices, Indices]:
    """Return pairs of edges, the first one of the lower number, that join the same nodes in opposite ways."""
    reach = np.minimum(np.maximum(tolerance * edges.length, edges.slack), _MOST * edges.length)
    place = 0.5 * (edges.start + edges.end) @ _DIRECTION
    row = np.argsort(place, kind="stable")
    ordered = place[row]
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

    def rank(self, edges: _Edges) -> tuple[bool, int, int, int]:
        """Return what decides between runs that claim the same edges."""
        a, b = self.own[0], self.donor[0]
        return bool(edges.block[a] != edges.block[b]), -len(self.own), int(a), int(b)

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
