"""What tests measure of the one grid of many blocks in a file."""

import numpy as np

from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid


def grid_of(name: str) -> Grid:
    """Return the only grid of a file."""
    (grid,) = read_grids(name)
    return grid


def cells(grid: Grid) -> int:
    """Return the count of cells of all blocks."""
    return sum((block.counts[0] - 1) * (block.counts[1] - 1) for block in grid.blocks)


def first_cells(grid: Grid) -> np.ndarray:
    """Return the heights of the cells at bodies, which blocks have south of them."""
    walls = [patch for patch in grid.outer_patches() if patch.kind == "wall"]
    assert {patch.side for patch in walls} == {"south"}
    nodes = [grid.blocks[patch.block].nodes[patch.start : patch.stop + 1, :2] for patch in walls]
    return np.concatenate([np.hypot(*(each[:, 1] - each[:, 0]).T) for each in nodes])
