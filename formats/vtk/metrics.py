"""Grids with all quality metrics as cell data: ``.vts`` files of one block, ``.vtm`` files of several."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import only_one
from meshonet.formats.vtk import vtm
from meshonet.formats.vtk.vts import write
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import folded_cells, per_cell_of_blocks
from meshonet.geometry.quality.metrics import metrics_of as metrics_of_cells


def write_metrics(path: Path, grids: Iterable[Grid], *, many: bool = False) -> None:
    """Write grids and quality metrics: with `many` all grids as ``.vtm``, else a single grid as ``.vts``.

    Raises InputError if a grid with several blocks is to be written as ``.vts``.
    """
    if many:
        vtm.write_grids(path, grids, cell_data=metrics_of)
        return
    grid = only_one(grids, "a .vts file")
    if len(grid.blocks) > 1 or (grid.form == "plane" and grid.topology == "blocks"):
        raise InputError(f"a .vts file holds one block, not {len(grid.blocks)}", "name it FILE.vtm")
    write(path, grid, metrics_of(grid)[0])


def metrics_of(grid: Grid) -> list[dict[str, NDArray[Any]]]:
    """Return, for each block, cell arrays (ni-1, nj-1[, nk-1]) by name: all metrics, and ``folded``."""
    every = {metric.name: per_cell_of_blocks(grid, metric.name) for metric in metrics_of_cells(grid)}
    of_blocks: list[dict[str, NDArray[Any]]] = []
    for number, block in enumerate(grid.blocks):
        folded = np.zeros([count - 1 for count in block.counts], dtype=np.int8)
        folded[tuple(folded_cells(block.nodes).T)] = 1
        of_blocks.append({**{name: cells[number] for name, cells in every.items()}, "folded": folded})
    return of_blocks
