"""Vinokur's stretching between prescribed cell sizes at both ends."""

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import tan, tanh
from meshonet.geometry.errors import InputError


@dataclass(frozen=True)
class TanhLaw:
    """Vinokur's two-sided stretching s(q) from ds/dq at `start` and `end`; q and s are from 0 to 1.

    u = 1/2 + tanh(d (q - 1/2)) / (2 tanh(d/2)), s = u / (a + (1 - a) u), a = sqrt(end/start), sinh(d)/d =
    1/sqrt(start end). If start·end > 1, tan and sin replace tanh and sinh. Vinokur, J. Comput. Phys.
    50 (1983) 215-234.
    """

    start: float
    end: float

    @property
    def stretch(self) -> float:
        """The parameter d of the formula: positive for tanh, negative for tan, 0 for equal steps."""
        b = 1.0 / math.sqrt(self.start * self.end)
        if abs(b - 1.0) < 1e-9:
            return 0.0
        return _inverse_sinhc(b) if b > 1.0 else -_inverse_sinc(b)

    def __call__(self, q: Floats) -> Floats:
        """Return s at q (any shape)."""
        a, d = math.sqrt(self.end / self.start), self.stretch
        u = np.asarray(q, dtype=np.float64)
        if d > 0:
            u = 0.5 + 0.5 * tanh(d * (u - 0.5)) / math.tanh(0.5 * d)
        elif d < 0:
            u = 0.5 + 0.5 * tan(d * (u - 0.5)) / math.tan(0.5 * d)
        s = u / (a + (1.0 - a) * u)
        return np.asarray(np.where(np.asarray(q) >= 1.0, 1.0, np.where(np.asarray(q) <= 0.0, 0.0, s)))

    def _end_steps(self, low_q: float, high_q: float) -> tuple[float, float]:
        """Return s at `low_q` and 1 - s at 1 - `high_q` without cancellation."""
        a, d = math.sqrt(self.end / self.start), self.stretch
        low, high = (_small_u(d, q) for q in (low_q, high_q))
        return low / (a + (1.0 - a) * low), a * high / (1.0 - (1.0 - a) * high)

    @classmethod
    def fitted(cls, cells: float, first: float, last: float, last_part: float = 1.0) -> Self:
        """Return the law of `cells` cells from s = 0 to 1. The first is `first` long, the last `last`.

        With `last_part` = 0.5, only half of the last cell lies before s = 1, and `cells` counts it as a half.
        Raises InputError: no law fits, as when both lengths are too large for so few cells.
        """
        start, end = first * cells, last * cells
        for _ in range(60):
            law = cls(start, end)
            begin, close = law._end_steps(1.0 / cells, last_part / cells)
            rise, fall = first / begin, last * last_part / close
            if max(abs(rise - 1.0), abs(fall - 1.0)) < 1e-6:
                return law
            start, end = start * min(max(rise, 0.25), 4.0), end * min(max(fall, 0.25), 4.0)
        raise InputError(
            f"steps of {first:.3g} and {last:.3g} of the length do not join over {cells:g} cells",
            "change the spacing or the number of nodes",
        )


def _small_u(d: float, q: float) -> float:
    """Return Vinokur's u at q, for q near 0: 1/2 - tanh(d/2 - d q) / (2 tanh(d/2)) without cancellation."""
    if d == 0:
        return q
    if d > 0:
        return 0.5 * math.sinh(d * q) / (math.sinh(0.5 * d) * math.cosh(d * (0.5 - q)))
    return 0.5 * math.sin(-d * q) / (math.sin(-0.5 * d) * math.cos(d * (0.5 - q)))


def _inverse_sinhc(b: float) -> float:
    """Return d with sinh(d)/d = b > 1, by Newton's method on the logarithm."""
    d = math.sqrt(6.0 * (b - 1.0)) if b < 3.0 else math.log(2.0 * b) + math.log(math.log(2.0 * b))
    for _ in range(40):
        d = min(d, 700.0)
        step = (math.log(math.sinh(d) / d) - math.log(b)) / (1.0 / math.tanh(d) - 1.0 / d)
        d -= step
        if abs(step) < 1e-13 * d:
            break
    return d


def _inverse_sinc(b: float) -> float:
    """Return d below pi with sin(d)/d = b < 1, by Newton's method on sin(d) - b d."""
    d = math.pi * (1.0 - b) if b < 0.27 else math.sqrt(6.0 * (1.0 - b))
    for _ in range(40):
        step = (math.sin(d) - b * d) / (math.cos(d) - b)
        d = min(max(d - step, 0.5 * d), 0.5 * (d + math.pi))
        if abs(step) < 1e-14 * d:
            break
    return d
