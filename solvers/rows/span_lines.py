"""Polynomials along the span through values at key sections."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import cos, product
from meshonet.geometry.linear import inverse
from meshonet.geometry.threads import in_threads

_AT_ONCE = 1 << 15
"""Values that are worked out together, so that they stay in the cache."""


def key_heights(count: int) -> Floats:
    """Return `count` heights from 0 to 1, the extrema of a Chebyshev polynomial."""
    heights = 0.5 * (1.0 - cos(np.pi * np.arange(count) / (count - 1)))
    heights[0], heights[-1] = 0.0, 1.0
    return np.asarray(heights)


@dataclass(frozen=True, eq=False)
class SpanLines:
    """Chebyshev coefficients (k, n, ...) of functions of the height, 0 to 1."""

    coefficients: Floats

    @classmethod
    def through(cls, values: Floats, degree: int | None = None) -> SpanLines:
        """Return the polynomials through values (k, n, ...) at `key_heights` (k).

        Of a lower `degree` they are those nearest to the values, with half weights at both ends.
        """
        count = len(values)
        at_keys = np.stack(_polynomials(2.0 * key_heights(count) - 1.0, count), axis=1)
        kept = inverse(at_keys)[: count if degree is None else degree + 1]
        return cls(product(kept, values.reshape(count, -1)).reshape(len(kept), *values.shape[1:]))

    def at(self, heights: Floats, columns: slice | Floats | None = None) -> Floats:
        """Return values (p, m, ...) of all n or some `columns` (m,) at heights (p, m) or (p, 1)."""
        c = self.coefficients if columns is None else self.coefficients[:, columns]
        x = (4.0 * heights - 2.0).reshape(*heights.shape, *(1,) * (c.ndim - 2))
        out = np.empty((len(heights), *np.broadcast_shapes(x.shape[1:], c.shape[1:])))
        own = max(1, _AT_ONCE * out.shape[1] // max(out.size, 1))

        def work(start: int) -> None:
            part = slice(start, start + own)
            _clenshaw(c[:, part], x if x.shape[1] == 1 else x[:, part], out[:, part])

        in_threads(work, range(0, out.shape[1], own))
        return out

    def slopes_at_keys(self) -> Floats:
        """Return derivatives (k, n, ...) by the height at `key_heights` (k)."""
        c = self.coefficients
        slopes = np.zeros_like(c)
        for k in range(len(c) - 1, 0, -1):
            slopes[k - 1] = 2.0 * k * c[k] + (slopes[k + 1] if k + 1 < len(c) else 0.0)
        slopes[0] *= 0.5
        return SpanLines(2.0 * slopes)._at_keys()

    def integrals_at_keys(self) -> Floats:
        """Return integrals (k, n, ...) over the height, from 0, at `key_heights` (k)."""
        c = self.coefficients
        sums = np.zeros((len(c) + 1, *c.shape[1:]))
        for k in range(1, len(c) + 1):
            before = c[k - 1] * (2.0 if k == 1 else 1.0)
            sums[k] = (before - (c[k + 1] if k + 1 < len(c) else 0.0)) / (4.0 * k)
        at_keys = SpanLines(sums)._at_keys(len(c))
        return at_keys - at_keys[0]

    def _at_keys(self, count: int | None = None) -> Floats:
        heights = key_heights(count or len(self.coefficients))
        return self.at(heights[:, None])


def _clenshaw(c: Floats, x: Floats, out: Floats) -> None:
    """Fill `out` (p, m, ...) with the sums of c (k, m, ...) times Chebyshev polynomials of x / 2.

    Clenshaw, Math. Comp. 9 (1955) 118.
    """
    after, here = np.zeros(out.shape), np.broadcast_to(c[-1], out.shape).copy()
    for row in c[-2:0:-1]:
        after *= -1.0
        after += x * here
        after += row
        after, here = here, after
    np.multiply(0.5 * x, here, out=out)
    out -= after
    out += c[0]


def _polynomials(x: Floats, count: int) -> list[Floats]:
    """Return the first `count` Chebyshev polynomials (n,) at x (n,)."""
    found = [np.ones_like(x), x]
    while len(found) < count:
        found.append(2.0 * x * found[-1] - found[-2])
    return found[:count]
