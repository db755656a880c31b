"""The centre of a cell whose indices a report names."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid


def centre_of(grid: Grid, at: tuple[int, ...]) -> Floats:
    """Return the centre (2,) or (3,) of the cell `at`: (i, j), (block, i, j) or (block, i, j, k).

    An index of the last node along a direction counts as that of the last cell.
    """
    block, *place = at if len(at) > 2 else (0, *at)
    nodes = grid.blocks[block].nodes
    counts = nodes.shape[:-1]
    corners = tuple(slice(m := min(k, n - 2), m + 2) for k, n in zip(place, counts, strict=True))
    return np.asarray(nodes[corners].mean(axis=tuple(range(len(counts)))))
