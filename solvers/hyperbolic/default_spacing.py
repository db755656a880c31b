"""Marched C grids whose first-cell height follows from the node spacing of the wall.

Elliptic C grids, whose wake nodes are fixed, have first cells of up to a tenth of the chord.
"""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, growth_ratios, norms
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.base_wake import COARSEST
from meshonet.geometry.shapes.wake import C_EDGE
from meshonet.solvers.hyperbolic.march import hyperbolic
from meshonet.solvers.solution import Solution

PART = 0.05
"""Ratio of the first-cell height to the smallest wall cell; with 0.25, lines lean by up to 80 degrees."""
MOST = 0.25  # the same where rows are few, so that they grow by no more than `GROWTH`
GROWTH = 1.2  # largest ratio of neighbouring rows
CHOSEN = "{first_cell} is not given: the first-cell height follows from the length of the shortest wall cell"
TALL, TALL_AROUND = 0.75, 0.02
"""First-cell heights above which marched lines bunch: C grids, per smallest wall cell; O grids, in chords."""
CHECKED, ABRUPT = 0.002, 2.0
"""First-cell height (chords) above which marched O grids are checked, and largest permitted growth ratio."""
_TALLEST = 3000  # rows beyond which the power of the growth ratio would exceed the range of numbers
STEEPEST = 1.3  # growth beyond which marched grids have larger angles than variational ones


def first_cell(boundary: Boundary) -> float:
    """Return the default first-cell height of a C boundary, in the unit of the boundary."""
    away = float(np.hypot(*(boundary.west[-1] - boundary.west[0])))
    return _height(_smallest(boundary), away, boundary.nj)


def too_tall(boundary: Boundary, height: float) -> bool:
    """Return whether first cells of `height`, in the unit of the boundary, are too high to be marched."""
    if boundary.topology == "c":
        return height > TALL * _smallest(boundary)
    return height > TALL_AROUND * boundary.chord


def is_abrupt(boundary: Boundary, height: float, growth: float | None, nodes: Floats) -> bool:
    """Return whether cell heights in a marched O grid, `nodes` (ni, nj, 2), jump from one row to the next.

    `height` is that of first cells, in the unit of `boundary`, `growth` the prescribed growth ratio, if any.
    """
    if boundary.topology == "c" or height <= CHECKED * boundary.chord:
        return False
    cells = np.maximum(norms(np.diff(nodes, axis=1)), 1e-300)
    return bool(growth_ratios(cells).max() > ABRUPT * (growth or 1.0))


def _smallest(boundary: Boundary) -> float:
    """Return the length of the smallest wall cell."""
    behind = boundary.wake
    wall = boundary.south[behind : boundary.ni - behind]
    return float(np.hypot(*np.diff(wall, axis=0).T).min())


def first_cell_around_base(width: float, away: float, chord: float, ni: int, nj: int) -> float:
    """Return the default first-cell height of a C grid around a body with a blunt base of this `width`.

    It follows from the distance `away` to the far field, the `nj` nodes over it, and the smallest wall cell.
    The length of this cell is the lesser of two estimates: from `width`, and from `chord` and `ni`.
    """
    return _height(min(C_EDGE / ni * chord, COARSEST * width), away, nj)


def _height(smallest: float, away: float, nj: int) -> float:
    gentle = away * (GROWTH - 1.0) / (GROWTH ** min(nj - 1, _TALLEST) - 1.0)
    return max(PART * smallest, min(gentle, MOST * smallest))


def march_by_default(boundary: Boundary) -> Solution | None:
    """Return the C grid marched from `boundary`; None if another method suits better.

    Another method suits better if the far-field nodes are given, if cells would grow by more than `STEEPEST`,
    or if cells fold.
    """
    if boundary.wall is None:
        return None
    try:
        solution = hyperbolic(boundary, wall_spacing=first_cell(boundary) / boundary.chord, growth=STEEPEST)
    except (InputError, SolverError):
        return None
    if count_folded(solution.grid.nodes):
        return None
    return replace(solution, notes=(*solution.notes, CHOSEN))
