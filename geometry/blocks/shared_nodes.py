"""One number for every node of a grid of blocks, the same where connected sides share it.

::

    block 0       block 1          numbers
    +--+--+       +--+--+          0--2--4--6--8
    |  |  |   +   |  |  |     ->   |  |  |  |  |
    +--+--+       +--+--+          1--3--5--7--9
         east = west
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.polygon.corners import Indices


def shared_nodes(
    counts: Sequence[tuple[int, ...]], connections: Sequence[Connection], *, periodic: bool = False
) -> tuple[Indices, ...]:
    """Return numbers from 0 on for the nodes of blocks with `counts` nodes along their directions.

    Nodes that connections join, directly or through others, have one number; numbers ascend in the order in
    which nodes first appear, block after block, the last index fastest. Both sides of a periodic connection
    have numbers of their own unless `periodic` says that they are one.
    """
    ends = np.cumsum([0, *(int(np.prod(count)) for count in counts)])
    numbers = [
        np.arange(first, last).reshape(count)
        for first, last, count in zip(ends, ends[1:], counts, strict=False)
    ]

    def face(block: int, side: Side) -> Indices:
        return np.asarray(face_of(numbers[block], side)[..., None])

    joined = [replace(each, transform=None) for each in connections if periodic or each.transform is None]
    changed = True
    while changed:  # as often as blocks meet in one node
        changed = False
        for connection in joined:
            own, donor = connection.nodes(face)
            least = np.minimum(own, donor)
            changed = changed or bool((own != donor).any())
            own[...], donor[...] = least, least
    if not joined:
        return tuple(numbers)
    kept = np.zeros(int(ends[-1]), dtype=bool)
    for number in numbers:
        kept[number.ravel()] = True
    rank = np.cumsum(kept) - 1
    return tuple(rank[number] for number in numbers)
