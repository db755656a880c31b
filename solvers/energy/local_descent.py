"""The minimum on windows around folded and skewed cells, which starts of whole descents lack most.

Splines smear what corners of a wall do to the lines that leave them. There the functional is far from a
parabola, and whole descents spend most of their iterations on a few cells.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats, as_planar
from meshonet.geometry.quality.measure import count_folded
from meshonet.kernels._native import VariationalDescent, variational_energy, variational_workspace
from meshonet.solvers.energy.clusters import windows
from meshonet.solvers.energy.functional import Weights
from meshonet.solvers.energy.preconditioner import minimiser

SKEWED = 1.5
"""1/sin⁴ of an angle, here 65 or 115 degrees, from which on a cell has a window around it."""

MARGIN = 6
"""Cells around a group of such ones that move with them."""

LARGEST = 1500
"""Cells of a window at the most."""

ITERATIONS = 30
"""In a window at the most."""

STILL = 1e-3
"""Moves at which it stops sooner, as `meshonet.solvers.energy.variational.STILL`."""

REACH = 0.25
"""Cells that a node moves at the most in a first iteration."""


def descend_windows(nodes: Floats, aspect: float, weights: Weights, relief: Floats) -> None:
    """Unfold planar `nodes` (ni, nj, 2) of an O grid in windows, and minimise in these, in place.

    Parameters
    ----------
    aspect, weights : of the functional.
    relief : as `meshonet.solvers.energy.functional.relief_of`.
    """
    skewed = skewness(nodes)
    poor = np.argwhere(skewed > SKEWED)
    if 2 * len(poor) > skewed.size:
        poor = np.argwhere(skewed == np.inf)
    if len(poor) == 0:
        return
    terms = aspect, weights.shape, weights.smoothness
    for window in windows(poor, MARGIN, nodes.shape[:2], True, LARGEST):
        rows = np.arange(window.i0, window.i1 + 1) % (len(nodes) - 1)
        patch = as_planar(nodes[rows, window.j0 : window.j1 + 1])
        m, n = patch.shape[:2]
        if min(m, n) < 3:
            continue
        z, descent = np.moveaxis(patch, -1, 0), minimiser(m, n, False, aspect, weights)
        if count_folded(patch) and not unfold(z, descent, terms):
            continue
        eased = relief[rows] if window.j0 == 0 else None
        still = STILL * float(np.sqrt((m - 1) * (n - 1)))
        descent.run(z, *terms, 0.0, eased, still, REACH, ITERATIONS)
        nodes[rows[1:-1], window.j0 + 1 : window.j1] = patch[1:-1, 1:-1]
        nodes[-1] = nodes[0]


def skewness(nodes: Floats) -> Floats:
    """Return the largest 1/sin⁴ of the angles of each cell of `nodes` (ni, nj, 2), infinite where folded."""
    z = nodes[..., 0] + 1j * nodes[..., 1]
    along, across = np.diff(z, axis=0), np.diff(z, axis=1)
    g, h = np.abs(along), np.abs(across)
    least = np.full((len(z) - 1, z.shape[1] - 1), np.inf)
    for south in (slice(None, -1), slice(1, None)):
        for west in (slice(None, -1), slice(1, None)):
            area = (np.conj(along[:, south]) * across[west]).imag
            np.minimum(least, area / np.maximum(g[:, south] * h[west], 1e-300), out=least)
    with np.errstate(divide="ignore"):
        return np.asarray(np.where(least > 0.0, least, 0.0) ** -4.0)


def unfold(z: Floats, descent: VariationalDescent, terms: tuple[float, float, float]) -> bool:
    """Unfold the planes `z` (2, ni, nj) in place by minimising with regularised Jacobians; return success."""
    nodes = np.moveaxis(z, 0, -1)
    ni, nj = nodes.shape[:2]
    cell = _area(nodes) / ((ni - 1) * (nj - 1))
    work = np.empty(variational_workspace(ni, nj))
    smallest = variational_energy(z, *terms, 0.0, False, None, np.empty_like(z), work)[1]
    epsilon = max(0.05 * cell, -0.5 * smallest)
    for _ in range(25):
        if descent.run(z, *terms, epsilon, None, 1e-3, REACH, 40)[1] > 0:
            return True
        epsilon *= 0.4
    return False


def _area(nodes: Floats) -> float:
    """Return the area inside the rim of `nodes`."""
    x, y = np.concatenate([nodes[:-1, 0], nodes[-1, :-1], nodes[:0:-1, -1], nodes[0, :0:-1]]).T
    x, y = x - x[0], y - y[0]
    return float(abs(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
