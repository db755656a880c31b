"""Arrays copied between the order of files (first index fastest) and that of memory (last index fastest).

Copied plane by plane, so that both the rows that are read and those that are written stay in the cache: a
block of 257 x 257 x 257 nodes takes 0.2 s, at once 0.4 s.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

_ROWS = 16
"""Rows copied at a time: as many numbers as two cache lines have."""


def put(target: NDArray[Any], values: NDArray[Any]) -> None:
    """Copy `values` to `target` of the same shape and other order in memory, number types converted."""
    if values.ndim == 3:
        for j in range(values.shape[1]):
            target[:, j] = values[:, j]
        return
    for start in range(0, values.shape[1], _ROWS):
        rows = slice(start, start + _ROWS)
        target[:, rows] = values[:, rows]


def first_fastest(values: NDArray[Any], dtype: str | np.dtype[Any]) -> NDArray[Any]:
    """Return `values` (ni, nj) or (ni, nj, nk) flat, i fastest, as numbers of `dtype`."""
    out = np.empty(values.shape[::-1], dtype)
    put(out.T, values)
    return out.reshape(-1)


def nodes_of(coordinates: Sequence[NDArray[Any]]) -> Floats:
    """Return nodes (..., d) of float64 in planar layout (`meshonet.geometry.arrays`) from d coordinates."""
    nodes = np.empty((len(coordinates), *coordinates[0].shape))
    for row, values in zip(nodes, coordinates, strict=True):
        put(row, values)
    return np.moveaxis(nodes, 0, -1)
