"""Repairs the folded cells of a volume in windows around them, with fixed faces."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import folded_cells
from meshonet.geometry.quality.volumes import solid_metric
from meshonet.solvers.energy.clusters import Window, windows
from meshonet.solvers.energy.hex_functional import OPENING, OPTIMAL, UNFOLDING
from meshonet.solvers.energy.hexes import NEARLY
from meshonet.solvers.volumes.planes_descent import PlanesDescent

MARGINS = 5, 8, 11, 14  # numbers of nodes around folded cells in a window, for successive rounds
LARGEST_CELLS = 40_000  # of a window: two seconds of untangling
ROUNDS, ROUND = 20, 8  # largest number of rounds of untangling in a window, and iterations of each
FIRST, OPEN, LAST = 15, 8, 10  # iterations of the stages that improve the cells after untangling
ENOUGH = 0.02  # smallest Jacobian above which a window gets the complete functional


def repair(planes: Floats) -> int:
    """Untangle folded cells of a volume `planes` (3, ni, nj, nk) in place; return how many stay folded."""
    nodes = np.moveaxis(planes, 0, -1)
    bad = folded_cells(nodes)
    if min(planes.shape[1:]) < 3:
        return len(bad)
    for margin in MARGINS:
        if len(bad) == 0:
            break
        for window in windows(bad, margin, nodes.shape[:3], False, LARGEST_CELLS):
            _mend(nodes, window)
        bad = folded_cells(nodes)
    return len(bad)


def open_flat_cells(planes: Floats) -> None:
    """Move nodes of a volume `planes` (3, ni, nj, nk) in place, so that nearly flat cells become thicker."""
    nodes = np.moveaxis(planes, 0, -1)
    (scaled,) = solid_metric(Grid.from_nodes(nodes), "scaled_jacobian")
    for window in windows(np.argwhere(scaled < NEARLY), MARGINS[0], nodes.shape[:3], False, LARGEST_CELLS):
        _mend(nodes, window)


def _mend(nodes: Floats, window: Window) -> None:
    part = window.cut(nodes)
    if min(part.shape[:3]) > 2:
        _unfold(np.moveaxis(part, -1, 0))
        window.put(nodes, False, part)


def _unfold(part: Floats) -> None:
    """Untangle a window and open its cells, in place."""
    descent = PlanesDescent(part)
    if descent.unfold(descent.smallest(), ROUNDS, ROUND) <= 0.0:
        return
    descent.run(UNFOLDING, FIRST)
    if descent.run(OPENING[0], OPEN)[0] > ENOUGH:
        descent.run(OPTIMAL, LAST)
