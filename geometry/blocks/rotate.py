"""A grid turned by a quarter: xi runs where eta ran, and the grid stays right-handed.

::

        north                 west                old east becomes south, old west north,
    west     east   ->   south    north           old south west and old north east; the latter
        south                 east                two are counted from their other end
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

_SIDES: dict[Side, Side] = {"east": "south", "west": "north", "south": "west", "north": "east"}


def turned(grid: Grid) -> Grid:
    """Return `grid` turned, its patches too: node (i, j) comes to (j, ni-1-i).

    Raises InputError: an O or C grid, whose xi runs around the body by definition.
    """
    if grid.around_body:
        raise InputError(f"topology {grid.topology} has xi around the body", "swap four-sided grids only")
    patches = tuple(_turned(patch, grid.ni - 1) for patch in grid.patches)
    block = Block(np.swapaxes(grid.nodes, 0, 1)[:, ::-1], finite=True)
    return replace(grid, blocks=(block,), patches=patches)


def _turned(patch: Patch, last: int) -> Patch:
    side, start, stop = _SIDES[patch.side], patch.start, patch.stop
    if patch.side in ("south", "north"):
        start, stop = last - stop, last - start
    return replace(patch, side=side, start=start, stop=stop)
