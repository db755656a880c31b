"""Ranges of nodes on the sides of zones, as CGNS counts them: from 1, first and last node of every index."""

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Side

Integers = NDArray[np.int32]


def range_of(side: Side, first: int, last: int, counts: tuple[int, ...], planes: int) -> Integers:
    """Return the first and the last node (2, 2 or 3) of a stretch of a zone of `counts` nodes.

    Of 3 with all its `planes` when there are any.
    """
    i, j = (1 if side == "west" else counts[0]), (1 if side == "south" else counts[1])
    ends = [[k + 1, j] if side in ("south", "north") else [i, k + 1] for k in (first, last)]
    return np.array([[*ends[0], 1], [*ends[1], planes]] if planes else ends, np.int32)
