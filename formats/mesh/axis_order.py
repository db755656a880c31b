"""Conversion between the array order of files (first index fastest) and of memory (last index fastest)."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

_ROWS = 16  # number of rows copied at a time, so that source and destination stay in the cache


def first_fastest(values: NDArray[Any], dtype: str | np.dtype[Any]) -> NDArray[Any]:
    """Return `values` (ni, nj) or (ni, nj, nk) as a flat array of type `dtype`; index i varies fastest."""
    return np.ascontiguousarray(values.T, dtype).reshape(-1)


def nodes_of(coordinates: Sequence[NDArray[Any]]) -> Floats:
    """Return float64 nodes (..., d) from d arrays of coordinates; each coordinate is contiguous in memory."""
    nodes = np.empty((len(coordinates), *coordinates[0].shape))
    for row, values in zip(nodes, coordinates, strict=True):
        for start in range(0, values.shape[1], _ROWS):
            part = slice(start, start + _ROWS)
            row[:, part] = values[:, part]
    return np.moveaxis(nodes, 0, -1)
