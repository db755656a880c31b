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
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

_SIDES: dict[Side, Side] = {"east": "south", "west": "north", "south": "west", "north": "east"}


def turned(grid: Grid) -> Grid:
    """Return `grid` with node (i, j) at (j, ni-1-i), its parts along.

    Raises
    ------
    InputError
        an O or C grid, whose xi runs around the body by definition.
    """
    if grid.topology != "quad":
        raise InputError(f"topology {grid.topology} has xi around the body", "swap four-sided grids only")
    parts = tuple(_turned(part, grid.ni - 1) for part in grid.patches)
    return replace(grid, nodes=np.swapaxes(grid.nodes, 0, 1)[:, ::-1], patches=parts)


def _turned(part: Patch, last: int) -> Patch:
    side = _SIDES[part.side]
    if part.side in ("south", "north"):
        return Patch(part.name, side, last - part.stop, last - part.start)
    return Patch(part.name, side, part.start, part.stop)
