"""The inverse of the functional's Hessian on a uniform grid, by sine transforms.

There the harmonic term is a Laplacian and the edge length term a biharmonic operator, both diagonal in the
products of sines. One application costs two thin matrix products a coordinate while the grid is small, and
fast transforms when it is large.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from geometry.arrays import Floats
from solvers.variational.functional import Weights

Reals: TypeAlias = NDArray[Any]
"""float32 or float64 array."""

SINGLE = 150
"""Cells above which transforms are in single precision: enough for a preconditioner, in half the time."""

FAST = 1200
"""Cells above which a fast transform takes less time than a matrix product."""


class Preconditioner:
    """Divides the sine coefficients of the interior by the symbol of the Hessian.

    Parameters
    ----------
    ni, nj : nodes.
    cell : mean area of a cell.
    aspect : a of the functional.
    weights : of the functional.
    """

    def __init__(self, ni: int, nj: int, cell: float, aspect: float, weights: Weights) -> None:
        mi, mj = ni - 1, nj - 1
        along, across = _eigenvalues(mi)[:, None], _eigenvalues(mj)[None]
        symbol = aspect * along + across / aspect
        bending = aspect * (along**2 * mi**2 + along * across * mj**2)
        bending = bending + (across**2 * mj**2 + along * across * mi**2) / aspect
        scale = (cell * mi * mj) / (symbol + weights.smoothness * bending)
        self._along, self._across = (_Sines(n) for n in (mi, mj))
        self._precision = np.float32 if max(mi, mj) > SINGLE else np.float64
        self._scale = scale.astype(self._precision)

    def __call__(self, gradient: Floats) -> Floats:
        """Return the preconditioned `gradient` (2, ni, nj), zero on the rim as it is."""
        result = np.zeros_like(gradient)
        inner = self._across.rows(gradient[:, 1:-1, 1:-1].astype(self._precision))
        inner = self._along.columns(self._scale * self._along.columns(inner))
        result[:, 1:-1, 1:-1] = self._across.rows(inner)
        return result


class _Sines:
    """The orthonormal discrete sine transform of n - 1 values, its own inverse."""

    def __init__(self, n: int) -> None:
        self.n = n
        self._matrix: Reals | None = None
        if n <= FAST:
            k = np.arange(1, n)
            matrix = np.sqrt(2.0 / n) * np.sin(np.pi / n * (np.outer(k, k) % (2 * n)))
            self._matrix = matrix.astype(np.float32 if n > SINGLE else np.float64)

    def rows(self, values: Reals) -> Reals:
        """Transform `values` (2, m, n-1) along the last axis."""
        return _fast(values, self.n) if self._matrix is None else np.asarray(values @ self._matrix)

    def columns(self, values: Reals) -> Reals:
        """Transform `values` (2, n-1, m) along the middle axis."""
        if self._matrix is not None:
            return np.asarray(self._matrix @ values)
        turned = np.ascontiguousarray(values.swapaxes(1, 2))
        return np.ascontiguousarray(_fast(turned, self.n).swapaxes(1, 2))


def _fast(values: Reals, n: int) -> Reals:
    """Transform along the last axis by a real Fourier transform of the odd extension."""
    odd = np.zeros((*values.shape[:-1], 2 * n), values.dtype)
    odd[..., 1:n] = values
    odd[..., n + 1 :] = -values[..., ::-1]
    return np.asarray(np.fft.rfft(odd, axis=-1).imag[..., 1:n] * np.float32(-1.0 / np.sqrt(2.0 * n)))


def _eigenvalues(n: int) -> Floats:
    """Return those of the second difference with n cells and fixed ends, (n-1,)."""
    return np.asarray(4.0 * np.sin(np.pi * np.arange(1, n) / (2 * n)) ** 2)
