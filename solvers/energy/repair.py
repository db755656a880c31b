"""Repairs the folded cells of a grid by moving the nodes around them: in windows, or from coarser copies."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, as_planar, planar_nodes
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import product
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.quality.measure import count_folded, folded_cells, per_cell
from meshonet.solvers.energy.clusters import windows
from meshonet.solvers.energy.functional import Weights
from meshonet.solvers.energy.preconditioner import Descent
from meshonet.solvers.energy.untangle import unfold

UNFOLDING = (Weights(0.3, 0.0), 60), (Weights(0.0, 0.0), 60), (Weights(0.0, 0.0), 200)
"""Weights and numbers of iterations that are tried in turn, with decreasing regularisation, while cells stay
folded. The harmonic term alone untangles more cells, but with larger angles.
"""

SMOOTHING = Weights()  # weights with which the corners of an unfolded patch are opened

SMOOTHING_ITERATIONS = 1500  # at the most; it ends before by `SMOOTHING_STILL`
SMOOTHING_STILL = 3e-5  # displacement of nodes, in cells, below which the smoothing stops

MARGIN = 6  # cells around a group of folded ones that move with them, at first
MARGINS = (12, 16)  # those of later rounds, where cells stay folded
NESTED_MARGINS = (32, 64)  # the same for windows that are unfolded through coarser copies
LARGEST_CELLS = 2500  # cells of a grid or window up to which it is unfolded at once
FEW = 0.001  # fraction of folded cells up to which windows come before coarser copies
POOR = 0.1  # scaled Jacobian below which a cell that coarser copies left is smoothed
SHARP = 0.5  # radians by which an edge turns at a node that coarser copies must keep
FUTILE = 2.4e7  # nodes times iterations that may be spent on patches which stay folded: a second or two


@dataclass
class UnfoldingBudget:
    """Remaining work, in nodes times iterations, that untangling may spend without success."""

    left: float = FUTILE


def repair(nodes: Floats, periodic: bool, margin: int = MARGIN) -> int:
    """Untangle planar `nodes` (ni, nj, 2) in place; return the number of cells that stay folded.

    Boundary nodes are fixed. If `periodic` (O grids), the last row repeats the first, and both move. Regions
    of `margin` cells around folded cells are moved first.
    """
    bad = folded_cells(nodes)
    if min(nodes.shape[:2]) < 3 or len(bad) == 0:
        return len(bad)
    margins = (margin, *(wider for wider in MARGINS if wider > margin))
    if _few(len(bad), nodes) and _repair_windows(nodes, periodic, UnfoldingBudget(), margins) == 0:
        _smooth_windows(nodes, periodic, bad, margin)
        return 0
    budget = UnfoldingBudget()
    left = _repair_nested(nodes, periodic, budget)
    left = left and _repair_windows(nodes, periodic, budget, NESTED_MARGINS, nested=True)
    grid = Grid.from_nodes(nodes, "o" if periodic else "quad")
    poor = np.argwhere(per_cell(grid, "scaled_jacobian") < POOR)
    if left == 0 and _few(len(poor), nodes):
        _smooth_windows(nodes, periodic, poor, margin)
    return left


def _repair_windows(
    nodes: Floats, periodic: bool, budget: UnfoldingBudget, margins: tuple[int, ...] = (MARGIN, *MARGINS),
    nested: bool = False,
) -> int:  # fmt: skip
    """Untangle windows around folded cells, directly or (`nested`) through coarser copies; see `repair`."""
    largest = (16 if nested else 1) * LARGEST_CELLS
    left = count_folded(nodes)
    for cells in margins:
        if left == 0:
            break
        for window in windows(folded_cells(nodes), cells, nodes.shape[:2], periodic, largest):
            patch = window.cut(nodes, periodic)
            before = count_folded(patch)
            if before and (_repair_nested if nested else untangle)(patch, False, budget) < before:
                window.put(nodes, periodic, patch)
        left = count_folded(nodes)
    return left


def _smooth_windows(nodes: Floats, periodic: bool, cells: NDArray[np.int64], margin: int) -> None:
    for window in windows(cells, 2 * margin, nodes.shape[:2], periodic, LARGEST_CELLS):
        patch = window.cut(nodes, periodic)
        _smooth(patch)
        window.put(nodes, periodic, patch)


def untangle(patch: Floats, periodic: bool, budget: UnfoldingBudget) -> int:
    """Untangle and smooth the planar nodes `patch` (m, n, 2) in place; return how many cells stay folded."""
    if budget.left <= 0 or min(patch.shape[:2]) < 3:
        return count_folded(patch)
    spent, valid, tried = 0, False, patch
    for weights, iterations in UNFOLDING:
        tried = patch.copy(order="K")
        valid, done = unfold(tried, weights, periodic=periodic, iterations=iterations)
        spent += done * patch[..., 0].size
        if valid:
            break
    patch[...] = tried
    if valid:
        _smooth(patch, periodic)
    else:
        budget.left -= spent
    return count_folded(patch)


def _smooth(patch: Floats, periodic: bool = False) -> None:
    if min(patch.shape[:2]) > 2 and count_folded(patch) == 0:
        Descent(patch, SMOOTHING, periodic).run(SMOOTHING_STILL, SMOOTHING_ITERATIONS)


def _repair_nested(nodes: Floats, periodic: bool, budget: UnfoldingBudget) -> int:
    """Untangle coarser copies first, then this grid with their displacements; return as `repair`."""
    ni, nj = nodes.shape[:2]
    tangled = not _few(count_folded(nodes), nodes)
    small = ni * nj <= LARGEST_CELLS
    if ni * nj > LARGEST_CELLS // 2 and min(ni, nj) > 5:
        _follow_coarser(nodes, periodic, budget)
    elif tangled:
        untangle(nodes, periodic, budget)
    left = _repair_windows(nodes, periodic, budget)
    if left and small:
        left = untangle(nodes, periodic, budget)
    if left == 0 and small and tangled:
        _smooth(nodes, periodic)
    return left


def _follow_coarser(nodes: Floats, periodic: bool, budget: UnfoldingBudget) -> None:
    """Untangle a coarser copy of planar `nodes` (ni, nj, 2), and apply its displacements or its nodes."""
    ni, nj = nodes.shape[:2]
    i, j = _kept(nodes[:, 0], nodes[:, -1]), _kept(nodes[0], nodes[-1])
    coarse = as_planar(nodes[np.ix_(i, j)])
    if count_folded(coarse) == 0:
        return
    before = coarse.copy(order="K")
    _repair_nested(coarse, periodic, budget)
    moved = nodes + _between(coarse - before, i, j, ni, nj)
    filled = _between(coarse, i, j, ni, nj)
    filled[:, 0], filled[:, -1] = nodes[:, 0], nodes[:, -1]
    if not periodic:
        filled[0], filled[-1] = nodes[0], nodes[-1]
    nodes[...] = min(moved, filled, key=count_folded)


def _few(cells: int, nodes: Floats) -> bool:
    """Return whether `cells` are so few of all cells of `nodes` (ni, nj, 2) that windows come first."""
    return cells <= max(FEW * nodes.shape[0] * nodes.shape[1], 50)


def _kept(edge: Floats, opposite: Floats) -> NDArray[np.intp]:
    """Return about every second index of two opposite edges (n, 2), including ends and sharp corners."""
    n = len(edge)
    corners = np.flatnonzero(np.maximum(np.abs(turning(edge)), np.abs(turning(opposite))) > SHARP)
    if len(corners) > n // 8:  # a rough edge: all its nodes are alike
        corners = corners[:0]
    stops = np.concatenate([[0], corners, [n - 1]])
    pieces = [np.arange(a, b, 2) for a, b in pairwise(stops)]
    return np.concatenate([*pieces, [n - 1]])


def _between(values: Floats, i: NDArray[np.intp], j: NDArray[np.intp], ni: int, nj: int) -> Floats:
    """Return planar (ni, nj, 2), interpolated bilinearly between the `values` at rows i and columns j."""
    result = planar_nodes(ni, nj)
    along, across = (
        np.stack([np.interp(np.arange(n), knots, row) for row in np.eye(len(knots))], axis=1)
        for knots, n in ((i, ni), (j, nj))
    )
    for k in (0, 1):
        result[..., k] = product(product(along, values[..., k]), across.T)
    return result
