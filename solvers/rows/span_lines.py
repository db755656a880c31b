"""Polynomials along the span through values at key sections."""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.elementary import cos, product
from meshonet.geometry.linear import inverse
from meshonet.kernels._native import chebyshev_sums


def key_heights(count: int) -> Floats:
    """Return `count` heights from 0 to 1, the extrema of a Chebyshev polynomial."""
    heights = 0.5 * (1.0 - cos(np.pi * np.arange(count) / (count - 1)))
    heights[0], heights[-1] = 0.0, 1.0
    return np.asarray(heights)


@dataclass(frozen=True, eq=False)
class SpanLines:
    """n polynomials in the height (0 to 1), given by their k Chebyshev coefficients (k, n, ...)."""

    coefficients: Floats

    @classmethod
    def through(cls, values: Floats, degree: int | None = None) -> "SpanLines":
        """Return polynomials along the span through values (k, n, ...) at the k heights ``key_heights(k)``.

        With a `degree` below k - 1, return least-squares fits in which both ends have half weight.
        """
        kept = _fit(len(values))[: len(values) if degree is None else degree + 1]
        return cls(_times(kept, values))

    def of(self, columns: slice | Indices) -> "SpanLines":
        """Return the polynomials with the indices `columns`."""
        return SpanLines(self.coefficients[:, columns])

    def at(self, heights: Floats) -> Floats:
        """Return the values (p, n, ...) of the n polynomials at heights (p, n) or (p, 1)."""
        c = self.coefficients
        out, count = np.empty((len(heights), *c.shape[1:])), math.prod(c.shape[1:])
        flat = np.ascontiguousarray(c).reshape(len(c), count), np.ascontiguousarray(heights)
        chebyshev_sums(*flat, out.reshape(len(out), count))
        return out


def slopes_at_keys(values: Floats) -> Floats:
    """Return derivatives (k, n, ...) at ``key_heights(k)`` of polynomials with `values` (k, n, ...) there."""
    return _times(_slopes(len(values)), values)


def integrals_at_keys(values: Floats) -> Floats:
    """Integrate polynomials with `values` (k, ...) at heights ``key_heights(k)``, from 0 to each height."""
    return _times(_integrals(len(values)), values)


def _times(matrix: Floats, values: Floats) -> Floats:
    return product(matrix, values.reshape(len(values), -1)).reshape(len(matrix), *values.shape[1:])


@cache
def _fit(count: int) -> Floats:
    """Return the matrix (count, count) from values at key heights to Chebyshev coefficients."""
    return inverse(np.stack(_polynomials(2.0 * key_heights(count) - 1.0, count), axis=1))


@cache
def _slopes(count: int) -> Floats:
    """Return the matrix (count, count) from values at key heights to derivatives there."""
    c = _fit(count)
    slopes = np.zeros_like(c)
    for k in range(count - 1, 0, -1):
        slopes[k - 1] = 2.0 * k * c[k] + (slopes[k + 1] if k + 1 < count else 0.0)
    slopes[0] *= 0.5
    return SpanLines(2.0 * slopes).at(key_heights(count)[:, None])


@cache
def _integrals(count: int) -> Floats:
    """Return the matrix (count, count) from values at key heights to integrals there."""
    c = _fit(count)
    sums = np.zeros((count + 1, count))
    for k in range(1, count + 1):
        before = c[k - 1] * (2.0 if k == 1 else 1.0)
        sums[k] = (before - (c[k + 1] if k + 1 < count else 0.0)) / (4.0 * k)
    at_keys = SpanLines(sums).at(key_heights(count)[:, None])
    return at_keys - at_keys[0]


def _polynomials(x: Floats, count: int) -> list[Floats]:
    """Return the first `count` Chebyshev polynomials (n,) at x (n,)."""
    values = [np.ones_like(x), x]
    while len(values) < count:
        values.append(2.0 * x * values[-1] - values[-2])
    return values[:count]
