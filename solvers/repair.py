"""Unfold cells: minimise the corner energy of `solvers._repair` around the folded ones.

A grid with a few folded cells is unfolded on windows around them, which grow while they stay folded. A grid
folded all over is unfolded on coarser copies of itself first: the coarsest as a whole, then each finer one is
filled from it and what is left is unfolded on windows. Only inner nodes move, so the boundary stays as it is.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from geometry.arrays import Floats, as_planar
from geometry.quality import count_folded, folded_cells
from solvers._repair import minimise
from solvers.windows import Window, windows

MARGIN = 6
"""Cells around a group of folded ones that move with them in the first round."""

ROUNDS = 3
"""Rounds of windows, each with twice the margin of the last."""

FEW = 0.01
"""Fraction of folded cells up to which windows come before coarser copies."""

COARSEST = 33
"""A copy with this many nodes or fewer along a direction is unfolded as a whole."""

VALID = 1e-3
"""Smallest corner Jacobian, in areas of the reference cell, at which unfolding may stop."""


def repair(nodes: Floats, periodic: bool) -> int:
    """Unfold planar `nodes` (ni, nj, 2) in place; return how many cells stay folded.

    Parameters
    ----------
    nodes : the grid; its rim stays as it is.
    periodic : an O grid: column ni-1 repeats column 0, and both move together.
    """
    ni, nj = nodes.shape[:2]
    if min(ni, nj) < 3:
        return count_folded(nodes)
    if count_folded(nodes) <= max(FEW * ni * nj, 20) and unfold_windows(nodes, periodic) == 0:
        return 0
    return unfold_nested(nodes, periodic)


def unfold_windows(nodes: Floats, periodic: bool) -> int:
    """Unfold windows around folded cells, as `repair`."""
    left = count_folded(nodes)
    for k in range(ROUNDS):
        if left == 0:
            break
        for window in windows(folded_cells(nodes), MARGIN * 2**k, nodes.shape[:2], periodic):
            _unfold_window(nodes, window, periodic)
        left = count_folded(nodes)
    return left


def unfold_nested(nodes: Floats, periodic: bool) -> int:
    """Unfold coarser copies first and fill this grid from them, as `repair`."""
    ni, nj = nodes.shape[:2]
    if min(ni, nj) <= COARSEST:
        unfold(nodes, periodic)
        return count_folded(nodes)
    i, j = _kept(ni), _kept(nj)
    coarse = as_planar(nodes[np.ix_(i, j)])
    if count_folded(coarse):
        before = coarse.copy(order="K")
        unfold_nested(coarse, periodic)
        moved = nodes + _between(coarse - before, i, j, ni, nj)
        filled = _between(coarse, i, j, ni, nj)
        filled[:, 0], filled[:, -1] = nodes[:, 0], nodes[:, -1]
        if not periodic:
            filled[0], filled[-1] = nodes[0], nodes[-1]
        nodes[...] = min(moved, filled, key=count_folded)
    return unfold_windows(nodes, periodic)


def unfold(patch: Floats, periodic: bool = False) -> None:
    """Unfold, then smooth, the inner nodes of planar `patch` (m, n, 2) in place, as far as that goes.

    The regularisation ε shrinks with the worst corner, at least by half: small enough to tell folded from
    valid, large enough to let a cell unfold.
    """
    x, y = patch[..., 0], patch[..., 1]
    width, height = reference_lengths(patch)
    epsilon, best, idle = 1.0, -np.inf, 0
    for _ in range(20):
        _, _, smallest = minimise(x, y, width, height, periodic, 0.0, epsilon, 200, 1e-4, VALID)
        if smallest > 0:
            minimise(x, y, width, height, periodic, 0.5, 0.0, 100, 1e-3)
            return
        idle = 0 if smallest > 0.9 * best else idle + 1
        if idle == 3:
            return
        best = max(best, smallest)
        epsilon = min(0.5 * epsilon, max(0.2 * abs(smallest), 1e-6))


def reference_lengths(patch: Floats) -> tuple[Floats, Floats]:
    """Return the mean lengths of the cells of `patch` (m, n, 2) along xi (m-1,) and eta (n-1,)."""
    along, across = (np.diff(patch, axis=axis) for axis in (0, 1))
    width = np.hypot(along[..., 0], along[..., 1]).mean(axis=1)
    height = np.hypot(across[..., 0], across[..., 1]).mean(axis=0)
    return width, height


def _unfold_window(nodes: Floats, window: Window, periodic: bool) -> None:
    """Unfold one window in place, unless that leaves as many folded cells as before."""
    rows = np.arange(window.i0, window.i1 + 1)
    if periodic:
        rows %= nodes.shape[0] - 1
    patch = as_planar(nodes[rows, window.j0 : window.j1 + 1])
    before = count_folded(patch)
    unfold(patch)
    if count_folded(patch) >= before:
        return
    nodes[rows[1:-1], window.j0 + 1 : window.j1] = patch[1:-1, 1:-1]
    if periodic:
        nodes[-1] = nodes[0]


def _kept(n: int) -> NDArray[np.intp]:
    """Return every second of n indices and the last."""
    return np.minimum(2 * np.arange(n // 2 + 1), n - 1)


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
