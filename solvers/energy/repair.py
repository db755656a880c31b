"""Unfold cells: minimise the corner energy of `solvers._repair` around the folded ones.

A grid with a few folded cells is unfolded on windows around them, which grow while they stay folded. What
that cannot undo is unfolded on coarser copies of the grid first: the coarsest at once, then each finer one
follows, and what is left is unfolded on windows. Only inner nodes move, so the boundary stays as it is. What
cannot be unfolded is given up after a second or two.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, as_planar
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import count_folded, folded_cells, per_cell
from meshonet.solvers.energy.clusters import Window, windows
from meshonet.solvers.energy.untangle import Patience, smooth, unfold

MARGIN = 6
"""Cells around a group of folded ones that move with them, at first."""

MARGINS = (12, 16)
"""Those of later rounds, where cells stay folded."""

PATCHES = (32, 64)
"""The same for windows that are unfolded through coarser copies."""

LARGEST = 2500
"""Cells of a grid or window up to which it is unfolded at once."""

FEW = 0.001
"""Fraction of folded cells up to which windows come before coarser copies."""

POOR = 0.1
"""Scaled Jacobian below which a cell that coarser copies left is smoothed."""

SHARP = 0.5
"""Radians by which an edge turns at a node that coarser copies must keep."""


def repair(nodes: Floats, periodic: bool, margin: int = MARGIN) -> int:
    """Unfold planar `nodes` (ni, nj, 2) in place; return how many cells stay folded.

    Parameters
    ----------
    nodes : the grid; its rim stays as it is.
    periodic : an O grid: column ni-1 repeats column 0, and both move together.
    margin : cells around a group of folded ones that move with them, at first.
    """
    bad = folded_cells(nodes)
    if min(nodes.shape[:2]) < 3 or len(bad) == 0:
        return len(bad)
    if _few(len(bad), nodes) and unfold_windows(nodes, periodic, Patience(), margin) == 0:
        smooth_windows(nodes, periodic, bad, margin)
        return 0
    patience = Patience()
    left = unfold_nested(nodes, periodic, patience) and unfold_patches(nodes, periodic, patience)
    poor = np.argwhere(
        per_cell(Grid.from_nodes(nodes, "o" if periodic else "quad"), "scaled_jacobian") < POOR
    )
    if left == 0 and _few(len(poor), nodes):
        smooth_windows(nodes, periodic, poor, margin)
    return left


def unfold_windows(nodes: Floats, periodic: bool, patience: Patience, margin: int = MARGIN) -> int:
    """Unfold windows around folded cells, as `repair`."""
    left = count_folded(nodes)
    for cells in (margin, *(wider for wider in MARGINS if wider > margin)):
        if left == 0:
            break
        for window in windows(folded_cells(nodes), cells, nodes.shape[:2], periodic, LARGEST):
            patch = _cut(nodes, window, periodic)
            before = count_folded(patch)
            if before and unfold(patch, False, patience) < before:
                _put(nodes, window, periodic, patch)
        left = count_folded(nodes)
    return left


def smooth_windows(nodes: Floats, periodic: bool, cells: NDArray[np.int64], margin: int) -> None:
    """Smooth windows around `cells` (n, 2) of valid planar `nodes` (ni, nj, 2), in place."""
    for window in windows(cells, 2 * margin, nodes.shape[:2], periodic, LARGEST):
        patch = _cut(nodes, window, periodic)
        smooth(patch)
        if count_folded(patch) == 0:
            _put(nodes, window, periodic, patch)


def unfold_patches(nodes: Floats, periodic: bool, patience: Patience) -> int:
    """Unfold larger windows through coarser copies, as `repair`."""
    left = count_folded(nodes)
    for margin in PATCHES:
        if left == 0:
            break
        for window in windows(folded_cells(nodes), margin, nodes.shape[:2], periodic, 16 * LARGEST):
            patch = _cut(nodes, window, periodic)
            before = count_folded(patch)
            if before and unfold_nested(patch, False, patience) < before:
                _put(nodes, window, periodic, patch)
        left = count_folded(nodes)
    return left


def unfold_nested(nodes: Floats, periodic: bool, patience: Patience) -> int:
    """Unfold coarser copies first and let this grid follow, as `repair`."""
    ni, nj = nodes.shape[:2]
    tangled = not _few(count_folded(nodes), nodes)
    small = ni * nj <= LARGEST
    if ni * nj > LARGEST // 2 and min(ni, nj) > 5:
        _follow_coarser(nodes, periodic, patience)
    elif tangled:
        unfold(nodes, periodic, patience)
    left = unfold_windows(nodes, periodic, patience)
    if left and small:
        left = unfold(nodes, periodic, patience)
    if left == 0 and small and tangled:
        smooth(nodes, periodic)
    return left


def _follow_coarser(nodes: Floats, periodic: bool, patience: Patience) -> None:
    """Unfold a coarser copy of planar `nodes` (ni, nj, 2); move them as it moved, or fill them from it."""
    ni, nj = nodes.shape[:2]
    i, j = _kept(nodes[:, 0], nodes[:, -1]), _kept(nodes[0], nodes[-1])
    coarse = as_planar(nodes[np.ix_(i, j)])
    if count_folded(coarse) == 0:
        return
    before = coarse.copy(order="K")
    unfold_nested(coarse, periodic, patience)
    moved = nodes + _between(coarse - before, i, j, ni, nj)
    filled = _between(coarse, i, j, ni, nj)
    filled[:, 0], filled[:, -1] = nodes[:, 0], nodes[:, -1]
    if not periodic:
        filled[0], filled[-1] = nodes[0], nodes[-1]
    nodes[...] = min(moved, filled, key=count_folded)


def _few(cells: int, nodes: Floats) -> bool:
    """Return whether so few `cells` of `nodes` (ni, nj, 2) are meant that windows around them come first."""
    return cells <= max(FEW * nodes.shape[0] * nodes.shape[1], 50)


def _cut(nodes: Floats, window: Window, periodic: bool) -> Floats:
    """Return a planar copy of the nodes of `window`."""
    rows = np.arange(window.i0, window.i1 + 1)
    if periodic:
        rows %= nodes.shape[0] - 1
    return as_planar(nodes[rows, window.j0 : window.j1 + 1])


def _put(nodes: Floats, window: Window, periodic: bool, patch: Floats) -> None:
    """Set the inner nodes of `window` to those of `patch`."""
    rows = np.arange(window.i0 + 1, window.i1)
    if periodic:
        rows %= nodes.shape[0] - 1
    nodes[rows, window.j0 + 1 : window.j1] = patch[1:-1, 1:-1]
    if periodic:
        nodes[-1] = nodes[0]


def _kept(one: Floats, other: Floats) -> NDArray[np.intp]:
    """Return about every second index of two opposite edges (n, 2), the ends and sharp corners among them.

    A copy that lost the tip of a spike would lead its lines through the spike.
    """
    n = len(one)
    corners = np.flatnonzero(np.maximum(_turning(one), _turning(other)) > SHARP) + 1
    if len(corners) > n // 8:  # a rough edge: all its nodes are alike
        corners = corners[:0]
    stops = np.concatenate([[0], corners, [n - 1]])
    pieces = [np.arange(a, b, 2) for a, b in pairwise(stops)]
    return np.concatenate([*pieces, [n - 1]])


def _turning(points: Floats) -> Floats:
    """Return the angle in radians by which the polyline `points` (n, 2) turns at its inner points (n-2,)."""
    step = np.diff(points, axis=0)
    before, after = step[:-1], step[1:]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    turning: Floats = np.abs(np.arctan2(cross, (before * after).sum(axis=1)))
    return turning


def _between(values: Floats, i: NDArray[np.intp], j: NDArray[np.intp], ni: int, nj: int) -> Floats:
    """Return planar (ni, nj, 2), linear between the `values` at rows i and columns j."""
    result = np.moveaxis(np.empty((2, ni, nj)), 0, -1)
    rows, columns = np.arange(ni), np.arange(nj)
    left = np.minimum(np.searchsorted(i, rows, side="right") - 1, len(i) - 2)
    weight = ((rows - i[left]) / (i[left + 1] - i[left]))[:, None]
    for k in (0, 1):
        along = np.stack([np.interp(columns, j, row) for row in values[..., k]])
        result[..., k] = (1 - weight) * along[left] + weight * along[left + 1]
    return result
