"""Nodes next to a connection, on both sides of it, in the same order.

::

    own[2]  own[1]  own[0] = donor[0]  donor[1]  donor[2]
    --o-------o------------o--------------o---------o--     one such grid line for each node of the connection
"""

import numpy as np

from meshonet.geometry.arrays import Floats, Side
from meshonet.geometry.blocks.block import PLACES, Range, face_counts
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError


def across(grid: Grid, connection: Connection, depth: int) -> tuple[Floats, Floats]:
    """Return rows of nodes on both sides of a connection: first of its own block, then of the donor block.

    Both arrays are (depth, n, d), or (depth, n, m, 3) in volumes. A block with fewer than `depth` rows gives
    fewer. The first row is on the connection. Both arrays have the node order of the connection's side. If
    the connection is periodic, its motion is applied to the rows of its own block.
    """
    own, donor = (rows_beside(grid, *end, depth) for end in connection.ends)
    if connection.transform:
        own = connection.transform(own)
    axes = (0, *(abs(way) for way in connection.orientation), donor.ndim - 1)
    ways = (slice(None), *(slice(None, None, 1 if way > 0 else -1) for way in connection.orientation))
    return own, donor.transpose(axes)[ways]


def planar(grid: Grid) -> None:
    """Raise InputError unless all blocks of `grid` lie in the plane, with nodes (ni, nj, 2)."""
    for number, block in enumerate(grid.blocks):
        if block.nodes.shape[2:] != (2,):
            sizes = " x ".join(map(str, block.counts))
            problem = f"block {number} of {sizes} nodes is not in the plane"
            raise InputError(problem, "give blocks of two directions with x and y")


def rows_at(grid: Grid, patch: Patch, depth: int) -> Floats:
    """Return `depth` rows of nodes, (depth, n, d) or (depth, n, m, 3), of which the first is on a patch."""
    counts = face_counts(grid.blocks[patch.block].counts, patch.side)
    return rows_beside(grid, patch.block, patch.side, patch.range(counts), depth)


def rows_beside(grid: Grid, block: int, side: Side, span: Range, depth: int) -> Floats:
    """Return `depth` rows of nodes, (depth, n, d) or (depth, n, m, 3), inwards from part `span` of a side."""
    axis, end = PLACES[side]
    nodes = np.moveaxis(grid.blocks[block].nodes, axis, 0)
    return (nodes[::-1] if end else nodes)[(slice(depth), *(slice(first, last + 1) for first, last in span))]
