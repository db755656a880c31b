"""One patch of a grid, unfolded and smoothed by moving all its inner nodes at once.

The energy and its minimiser are compiled: see ``kernels/energy/repair.c``.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded
from meshonet.kernels._native import repair_minimise

VALID = 1e-3
"""Smallest corner Jacobian, in areas of the reference cell, at which unfolding may stop."""

STILL = 1e-3
"""Largest move of a node, in lengths of its reference cell, at which minimising stops."""

STEPS = 5
"""Newton steps for one regularisation."""

REGULARISATIONS = 30
PATIENCE = 3
"""Regularisations at the most, and those without gain after which unfolding is given up."""


FUTILE = 1e5
"""Nodes times regularisations that may be spent on patches which stay folded: a second or two."""


class Patience:
    """What may still be spent in vain. What unfolds a patch costs nothing, so many folds do not tire it.

    Parameters
    ----------
    left : nodes times regularisations.
    """

    def __init__(self, left: float = FUTILE) -> None:
        self.left = left


def unfold(patch: Floats, periodic: bool, patience: Patience) -> int:
    """Unfold, then smooth, the inner nodes of `patch` in place; return how many cells stay folded.

    The regularisation ε shrinks with the worst corner, at least by half: small enough to tell folded from
    valid, large enough to let a cell unfold.

    Parameters
    ----------
    patch : (m, n, 2) planar.
    periodic : row m-1 repeats row 0, and both are inner.
    patience : once it is at its end the patch is left as it is.
    """
    if patience.left <= 0:
        return count_folded(patch)
    x, y = patch[..., 0], patch[..., 1]
    width, height = reference_lengths(patch, periodic)
    epsilon, best, idle = 1.0, -np.inf, 0
    spent = 0.0
    for _ in range(REGULARISATIONS):
        spent += x.size
        _, _, smallest = repair_minimise(x, y, width, height, periodic, 0.0, epsilon, STEPS, STILL, VALID)
        if smallest > 0:
            smooth(patch, periodic)
            break
        idle = 0 if smallest > 0.9 * best else idle + 1
        if idle == PATIENCE:
            break
        best = max(best, smallest)
        epsilon = min(0.5 * epsilon, max(0.2 * abs(smallest), 1e-6))
    left = count_folded(patch)
    if left:
        patience.left -= spent
    return left


def smooth(patch: Floats, periodic: bool = False) -> None:
    """Open the corners of a valid `patch`, as `unfold`."""
    lengths = reference_lengths(patch, periodic)
    repair_minimise(patch[..., 0], patch[..., 1], *lengths, periodic, 0.5, 0.0, 4 * STEPS, STILL)


def reference_lengths(patch: Floats, periodic: bool) -> tuple[Floats, Floats]:
    """Return the lengths that the cells of `patch` (m, n, 2) should have along xi (m-1,) and eta (n-1,).

    They are the mean lengths, evened out: a folded grid bunches lines that need not stay so. The logarithm of
    a length is fitted by a parabola, which keeps geometric growth; around a ring lengths stay as they are.
    """
    along, across = (np.diff(patch, axis=axis) for axis in (0, 1))
    width = np.hypot(along[..., 0], along[..., 1]).mean(axis=1)
    height = np.hypot(across[..., 0], across[..., 1]).mean(axis=0)
    return (width if periodic else _evened(width)), _evened(height)


def _evened(lengths: Floats) -> Floats:
    if len(lengths) < 4:
        return lengths
    at = np.linspace(-1.0, 1.0, len(lengths))
    basis, _ = np.linalg.qr(np.stack([np.ones_like(at), at, at**2], axis=1))
    logarithms = np.log(np.maximum(lengths, 1e-12 * lengths.max()))
    evened: Floats = np.exp(basis @ (basis.T @ logarithms))
    return evened
