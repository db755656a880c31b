"""A limit on the growth of cells as a term of a function that is minimised.

With ρ the logarithms of the ratios of neighbouring cells, ρ0 those at first, cut to at most L::

    w Σ max(0, |ρ| - L)² + μ Σ (ρ - ρ0)²

w rises from step to step. In steps of Gauss-Newton ratios that nearly exceed the limit count as if they did:
that bounds the function from above, and steps do not alternate.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.least_squares import Residuals

EXCESS, RISE, MOST_WEIGHT = 10.0, 1.6, 1e4
"""w at first, what it is multiplied by in each step, and at the most."""
CHANGE = 1.0
"""μ."""
NEARLY = 0.05
"""How far below the limit, in logarithms, ratios count as if they exceeded it."""
LINEAR = 0.1
"""Excess beyond which it counts in proportion: what cannot be mended is not to bend all cells around."""
HALVINGS = 10

Numbers = TypeVar("Numbers", Floats, Complexes)


@dataclass(frozen=True, eq=False)
class GrowthLimit:
    """The term for logarithms of ratios (k,): `limit` is L, `wanted` (k,) ρ0."""

    limit: float
    wanted: Floats

    @classmethod
    def at(cls, growth: Floats, limit: float) -> GrowthLimit:
        """Return the term of a limit where ratios have the logarithms `growth` (k,) at first."""
        return cls(limit, np.clip(growth, -limit, limit))

    def values(self, growth: Floats, weight: float) -> Floats:
        """Return what each ratio (k,) adds to the term, for w = `weight`."""
        excess = np.maximum(np.abs(growth) - self.limit, 0.0)
        near = np.minimum(excess, LINEAR)
        return np.asarray(weight * near * (2.0 * excess - near) + CHANGE * (growth - self.wanted) ** 2)

    def residuals(self, growth: Floats, derivatives: Floats, weight: float) -> Residuals:
        """Return what a step of Gauss-Newton needs, of derivatives (k, m) of the logarithms."""
        excess = np.maximum(np.abs(growth) - self.limit, 0.0)
        pull = weight * np.minimum(1.0, LINEAR / np.maximum(excess, LINEAR))
        stiffness = np.where(np.abs(growth) > self.limit - NEARLY, CHANGE + pull, CHANGE)
        slope = CHANGE * (growth - self.wanted) + pull * np.copysign(excess, growth)
        return Residuals(derivatives, stiffness, slope)


def damped(values: Callable[[Numbers], Floats], at: Numbers, step: Numbers, part: Indices) -> Numbers:
    """Return parts of a step (m,) that lower each of several `values` (p,), 0 where none is found that does.

    `part` (m,) is the number of the value that each unknown changes.
    """
    start = values(at)
    share = np.ones(len(start))
    for _ in range(HALVINGS):
        higher = ~(values(at + share[part] * step) < start)  # nor what is no number
        if not higher.any():
            return np.asarray(share[part] * step)
        share[higher] *= 0.5
    share[higher] = 0.0
    return np.asarray(share[part] * step)
