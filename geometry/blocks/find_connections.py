"""The connections of blocks for which none are given: where they touch each other or themselves.

::

    +--+--+--+--+
    |  block 0  |      Every boundary cell is a directed edge with the block on its left. Two blocks that
    +--+--+-----+      touch run along their interface in opposite directions; blocks that merely coincide,
    |  |  |            such as copies, run in the same direction and are not joined. Parts of sides may be
    +--+--+            joined, and a side to itself, as at the wake of a C grid.
    block 1

The search itself is in `meshonet.geometry.blocks.meeting_sides`.
"""

from collections.abc import Iterable, Sequence
from typing import TypeAlias

from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES, Block, Range
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.meeting_sides import meeting_sides
from meshonet.geometry.errors import InputError

TOLERANCE = 1e-6  # largest distance of coincident nodes, divided by the length of the shorter of two edges
Stretch: TypeAlias = tuple[int, Side, int, int]
"""Part of the boundary of a planar block: block, side, first and last node."""
Part: TypeAlias = tuple[int, Side, Range]
"""Part of a side: block, side, and first and last node along each direction of the side."""


def find_connections(
    blocks: Sequence[Block], tolerance: float = TOLERANCE, *, without: Iterable[Stretch | Part] = ()
) -> tuple[Connection, ...]:
    """Return the connections of right-handed `blocks`, sorted by block and side.

    Two nodes count as equal if their distance is at most `tolerance` edge lengths, or at most one unit of the
    last digit of the coordinates (see `rounding`). `with_equal_nodes` can make them bitwise equal. `without`
    lists parts of sides that must not be connected. If more than two sides coincide, two sides of the same
    block are joined first, then sides of successive blocks.

    Raises InputError: some blocks have two coordinates, others three.
    """
    parts = [each if len(each) == 3 else (*each[:2], (each[2:],)) for each in without]
    planar = [block.nodes.shape[-1] == 2 for block in blocks]
    if any(planar) and not all(planar):
        raise InputError(
            f"block {planar.index(True)} has no z, others have", "give all of them two coordinates, or three"
        )
    return tuple(sorted(meeting_sides(blocks, tolerance, parts), key=order))


def order(connection: Connection) -> tuple[int, int, Range]:
    """Return the sort key of a connection: block, side and nodes."""
    return connection.block, list(PLACES).index(connection.side), connection.range
