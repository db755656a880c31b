"""Damping of splines near acute corners, so that they do not fold the thin cells there.

With coarse nodes X, matrices L of linear interpolation, B (`bending`), C (`cubic`) and damping K, fine nodes
are L X Lᵀ + C (K∘B X) Lᵀ + L (K∘X Bᵀ) Cᵀ + C (K∘B X Bᵀ) Cᵀ.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import functions_of, times
from meshonet.solvers.algebraic.resample.spline import places

ACUTE, WIDE = np.radians((30.0, 60.0))
"""Corner angles below which damping is complete, and above which there is none."""

NEAR, FAR = 4.0, 10.0
"""Distances from the corner, in coarse cells, below which damping is complete and above which it is 0."""


def openings(z: Any, xp: Any) -> Any:
    """Return weights (.., 2, 2) at the corners of coarse grids: 1 at acute angles, 0 at wide angles.

    There, finer grids are interpolated linearly with this weight, and by splines with the rest. `z`
    (.., m, n) are the coarse nodes as complex numbers, an array of the module `xp`, numpy or torch.
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
    """Return factors (4, m, n) at m x n nodes, which fall from 1 to 0 away from each of the four corners."""
    cells = np.maximum(*np.ogrid[0.0:m, 0.0:n])
    first = np.clip((FAR - cells) / (FAR - NEAR), 0.0, 1.0)
    return np.stack([first, first[:, ::-1], first[::-1], first[::-1, ::-1]])


@lru_cache(maxsize=16)
def cubic(n: int, count: int) -> Floats:
    """Return the matrix (count, n) that gives the difference of a spline from linear interpolation.

    It multiplies the spline's second derivatives at n uniform knots; the result is at `count` uniform places.
    """
    return _weighted(n, count, 2)


@lru_cache(maxsize=16)
def linear(n: int, count: int) -> Floats:
    """Return the matrix (count, n) of linear interpolation from n uniform knots to `count` uniform places."""
    return _weighted(n, count, 0)


def _weighted(n: int, count: int, k: int) -> Floats:
    """Return the matrix (count, n) of columns k and k + 1 of the weights of `places`."""
    first, weights = places(n, count)
    matrix, rows = np.zeros((count, n)), np.arange(count)
    matrix[rows, first], matrix[rows, first + 1] = weights[:, k], weights[:, k + 1]
    return matrix
