"""A grid with every quality metric as cell data, in a ``.vts`` file."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from meshonet.formats.format import only_one
from meshonet.formats.vtk.vts import write
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import folded_cells, per_cell
from meshonet.geometry.quality.metrics import NAMES


def write_metrics(path: Path, grids: Iterable[Grid]) -> None:
    """Write the one grid of `grids` to `path`."""
    grid = only_one(grids, "a .vts file")
    folded = np.zeros((grid.ni - 1, grid.nj - 1), dtype=np.int8)
    folded[tuple(folded_cells(grid.nodes).T)] = 1
    write(path, grid, {**{name: per_cell(grid, name) for name in NAMES}, "folded": folded})
