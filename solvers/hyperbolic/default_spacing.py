"""C grids without a given height of first cells: marched with one that suits the nodes of the wall.

Elliptic C grids hold the nodes of the wake, where small cells behind the edge face large ones of the far
field, and so their first cells are as high as a tenth of the chord. Marched from wall and wake they are a
part of the smallest cell along the wall, and grow by one ratio to the far field.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.hyperbolic.march import hyperbolic
from meshonet.solvers.solution import Solution

PART = 0.05
"""First cell over the smallest cell of the wall. At 0.25 lines lean by up to 80 degrees around some sections
with 400 rows; at 0.05 by 29 at the most, and by 4 around most."""
MOST = 0.25  # the same where rows are few, so that they grow by no more than `GROWTH`
GROWTH = 1.2
STEEPEST = 1.3  # growth beyond which marched grids have larger angles than variational ones


def first_cell(boundary: Boundary) -> float:
    """Return the height of first cells, in the unit of a C `boundary`."""
    behind = boundary.wake
    wall = boundary.south[behind : boundary.ni - behind]
    smallest = float(np.hypot(*np.diff(wall, axis=0).T).min())
    away = float(np.hypot(*(boundary.west[-1] - boundary.west[0])))
    gentle = away * (GROWTH - 1.0) / (GROWTH ** (boundary.nj - 1) - 1.0)
    return max(PART * smallest, min(gentle, MOST * smallest))


def march_by_default(boundary: Boundary) -> Solution | None:
    """Return the C grid marched from `boundary`, or None where another method suits better.

    That is where the far field is given node by node, since a march ends in its own; where rows are so few
    that cells would grow by more than `STEEPEST`; and where cells are folded.
    """
    if boundary.wall is None:
        return None
    try:
        solution = hyperbolic(boundary, wall_spacing=first_cell(boundary) / boundary.chord, growth=STEEPEST)
    except (InputError, SolverError):
        return None
    if count_folded(solution.grid.nodes):
        return None
    note = "no first cell was asked for: it follows from the smallest one along the wall"
    return replace(solution, notes=(*solution.notes, note))
