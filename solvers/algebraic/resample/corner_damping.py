"""Splines made less curved near acute corners, so that they do not fold the thin cells there.

Between the walls of an acute corner cells are much thinner than long, and lines turn within a cell or two of
the walls. A cubic through their nodes swings by more than the thickness of a cell; straight lines between
coarse nodes do not. So a share of the second derivatives is left out: all of them at the corner itself, less
with the distance from it and the wider it opens. With L the matrices of linear interpolation, C those of what
second derivatives B add between, and K the share left at each node::

    L X Lᵀ + C (K∘B X) Lᵀ + L (K∘X Bᵀ) Cᵀ + C (K∘B X Bᵀ) Cᵀ
"""

from functools import lru_cache
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import functions_of, times
from meshonet.solvers.algebraic.resample.spline import places

ACUTE, WIDE = np.radians((30.0, 60.0))
"""Angles of a corner up to which all is taken out, and from which nothing is."""

NEAR, FAR = 4.0, 10.0
"""Coarse cells from the corner, along xi or eta, up to which all is taken out, and from which nothing is."""


def openings(z: Any, xp: Any) -> Any:
    """Return how much is taken out at the four corners (.., 2, 2), 0 to 1, of grids `z` (.., m, n), complex.

    `xp` is numpy or torch.
    """
    west_east = xp.stack([z[..., 0, :], z[..., -1, :]], -2)
    beside = xp.stack([z[..., 1, :], z[..., -2, :]], -2)
    corner = xp.stack([west_east[..., 0], west_east[..., -1]], -1)
    along = xp.stack([beside[..., 0], beside[..., -1]], -1) - corner
    up = xp.stack([west_east[..., 1], west_east[..., -2]], -1) - corner
    angle = xp.abs(functions_of(xp).angle(times(along, up.conj())))
    return xp.clip((WIDE - angle) / (WIDE - ACUTE), 0.0, 1.0)


@lru_cache(maxsize=16)
def fading(m: int, n: int) -> Floats:
    """Return how much of what is taken out at each of the corners reaches each node, (4, m, n)."""
    cells = np.maximum(*np.ogrid[0.0:m, 0.0:n])
    first = np.clip((FAR - cells) / (FAR - NEAR), 0.0, 1.0)
    return np.stack([first, first[:, ::-1], first[::-1], first[::-1, ::-1]])


@lru_cache(maxsize=16)
def cubic(n: int, count: int) -> Floats:
    """Return the matrix (count, n) that takes second derivatives at n knots to what they add between."""
    return _weighted(n, count, 2)


@lru_cache(maxsize=16)
def linear(n: int, count: int) -> Floats:
    """Return the matrix (count, n) of linear interpolation between n knots."""
    return _weighted(n, count, 0)


def _weighted(n: int, count: int, k: int) -> Floats:
    """Return the matrix (count, n) of columns k and k + 1 of the weights of `places`."""
    first, weights = places(n, count)
    matrix, rows = np.zeros((count, n)), np.arange(count)
    matrix[rows, first], matrix[rows, first + 1] = weights[:, k], weights[:, k + 1]
    return matrix
