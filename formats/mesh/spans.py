"""Stretches of the sides of a plane block, given by node indices of the three-dimensional one in a file."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Side

Span: TypeAlias = tuple[Side, int, int]
"""Side, first and last node of it."""


def span_of(
    points: NDArray[Any], counts: tuple[int, ...], dropped: int, *, faces: bool = False
) -> Span | None:
    """Return the stretch of a side that node indices (n, 2 or 3) lie on, None where that is no side's.

    Of `faces` the last one ends at the next node.
    """
    if points.ndim != 2 or points.shape[1] not in (2, 3) or not len(points):
        return None
    indices = points.astype(np.int64) - 1
    if points.shape[1] == 3:
        indices = np.delete(indices, dropped, axis=1)
    (i0, j0), (i1, j1) = indices.min(axis=0).tolist(), indices.max(axis=0).tolist()
    ni, nj = counts
    more = int(faces)
    if j0 == j1 and j0 in (0, nj - 1) and 0 <= i0 < i1 + more < ni:
        return "south" if j0 == 0 else "north", i0, i1 + more
    if i0 == i1 and i0 in (0, ni - 1) and 0 <= j0 < j1 + more < nj:
        return "west" if i0 == 0 else "east", j0, j1 + more
    return None
