"""Lines between the columns of layers: cubics through four columns that do not reach over a corner."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.corners import Indices


def whole_columns(index: Floats) -> Floats:
    """Return column numbers (k,), those that are whole but for round-off made so."""
    near = np.round(index)
    return np.where(np.abs(index - near) < 1e-7, near, index)


def column_weights(index: Floats, low: Indices, high: Indices) -> tuple[Floats, Indices]:
    """Return weights (k, 4) of columns, and the first (k,) of them, at column numbers (k,) between columns.

    `low` and `high` (k,) are the first and last column of the stretch between corners that each lies in; the
    last weights are zero where that has fewer than four.
    """
    first = np.clip(index.astype(np.intp) - 1, low, np.maximum(high - 3, low))
    width = np.minimum(high - first, 3)
    offset = index - first
    weights = np.zeros((len(index), 4))
    for k in range(4):
        weight = np.ones(len(index))
        for knot in range(4):
            if knot != k:
                used = (knot <= width) & (k <= width)
                weight *= np.where(used, (offset - knot) / (k - knot), 1.0)
        weights[:, k] = np.where(k > width, 0.0, weight)
    return weights, first


def started(lines: Floats, begin: Floats) -> Floats:
    """Return lines (k, m, 2) moved to begin at points (k, 2), less and less on the way to their ends."""
    step = np.diff(lines, axis=1)
    height = np.cumsum(np.hypot(step[..., 0], step[..., 1]), axis=1)
    left = 1.0 - np.pad(height / height[:, -1:], ((0, 0), (1, 0)))
    moved = lines + left[..., None] * (begin - lines[:, 0])[:, None]
    moved[:, 0] = begin
    return np.asarray(moved)


def line_lengths(lines: Floats) -> Floats:
    """Return the lengths (k,) of lines (k, m, 2)."""
    return np.asarray(np.hypot(*np.diff(lines, axis=1).transpose(2, 0, 1)).sum(axis=1))
