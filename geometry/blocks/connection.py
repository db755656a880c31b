"""Where a grid meets itself: beyond the seam of an O grid, and across the wake of a C grid."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import wake_nodes


def wake_cells(grid: Grid) -> int:
    """Return how many cells of a ``c`` grid stand on each side of its wake, 0 for other grids.

    Node (i, 0) of the wake is node (ni-1-i, 0) too, bitwise; the cell that cell (i, 0) meets there is
    (ni-2-i, 0).
    """
    if grid.topology != "c":
        return 0
    return max(wake_nodes(grid.nodes[:, 0]) - 1, 0)


def beyond_seam(grid: Grid) -> Floats:
    """Return the nodes (ni + 1, nj, 2) of an O grid with column 1 again at the end; others as they are."""
    if grid.topology != "o":
        return grid.nodes
    return np.concatenate([grid.nodes, grid.nodes[1:2]])


def across_wake(grid: Grid) -> Floats:
    """Return the nodes (wake nodes, 3, 2) of a C grid across its wake, which is in the middle.

    Without a wake there are none.
    """
    cells = wake_cells(grid)
    nodes = cells + 1 if cells else 0
    below = grid.nodes[::-1][:nodes, 1]
    return np.stack([below, grid.nodes[:nodes, 0], grid.nodes[:nodes, 1]], axis=1)
