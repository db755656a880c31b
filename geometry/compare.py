"""How far two grids of the same size are apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.errors import InputError
from geometry.grid import Grid


@dataclass(frozen=True)
class Difference:
    """Distances between the nodes of two grids.

    Parameters
    ----------
    max, mean : greatest and mean distance, in the grids' unit of length.
    at : node (i, j) of the greatest.
    relative_l2 : root of the sum of squared distances over that of the other grid's coordinates, taken from
        the mean of its nodes so that it does not depend on where the origin is.
    """

    max: float
    mean: float
    at: tuple[int, int]
    relative_l2: float


def compare(grid: Grid, other: Grid) -> Difference:
    """Return how far the nodes of `grid` are from those of `other`.

    Raises
    ------
    InputError
        their node counts differ.

    Examples
    --------
    >>> square = np.stack(np.meshgrid([0.0, 1.0], [0.0, 1.0], indexing="ij"), axis=-1)
    >>> compare(Grid(square + [3.0, 4.0]), Grid(square)).max
    5.0
    """
    if grid.nodes.shape != other.nodes.shape:
        counts = f"{grid.ni}x{grid.nj} nodes are not comparable with {other.ni}x{other.nj}"
        raise InputError(counts, "compare grids of one size")
    away = np.hypot(grid.x - other.x, grid.y - other.y)
    i, j = np.unravel_index(int(away.argmax()), away.shape)
    extent = np.hypot(other.x - other.x.mean(), other.y - other.y.mean())
    relative = float(np.linalg.norm(away) / np.linalg.norm(extent))
    return Difference(float(away.max()), float(away.mean()), (int(i), int(j)), relative)
