"""Limits the growth of cells by a penalty term of a functional.

Let ρ be the logarithms of the ratios of neighbouring cells and ρ0 their initial values, limited to L. The
term is::

    w Σ max(0, |ρ| - L)² + μ Σ (ρ - ρ0)²

The weight w increases from step to step. In Gauss-Newton steps, ratios slightly below the limit are treated
as if they exceeded it, which prevents oscillations.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self, TypeVar

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, Indices
from meshonet.solvers.least_squares import Residuals

EXCESS, RISE, MOST_WEIGHT = 10.0, 1.6, 1e4  # initial w, its factor in each step, and its largest value
CHANGE = 1.0  # μ, if none is given
NEARLY = 0.05
"""Difference from the limit, in logarithms, within which ratios are treated as if they exceeded it."""
LINEAR = 0.1
"""Excess beyond which the penalty is linear: a ratio that cannot be reduced must not distort all cells."""
HALVINGS = 10  # largest number for a step that raises the value

Numbers = TypeVar("Numbers", Floats, Complexes)


@dataclass(frozen=True, eq=False)
class GrowthLimit:
    """The penalty w Σ max(0, |ρ| - L)² + μ Σ (ρ - ρ0)² for logarithms ρ (..., k) of growth ratios.

    `limit` is L, `wanted` (..., k) are the preferred values ρ0, `change` is μ. The methods' `weight` is w.
    """

    limit: float | Floats
    wanted: Floats
    change: float = CHANGE

    @classmethod
    def at(cls, growth: Floats, limit: float | Floats, change: float = CHANGE) -> Self:
        """Return a penalty on log growth ratios that exceed `limit` or differ from `growth` (..., k).

        `change` is the weight of differences. Values in `growth` are first clipped to ±`limit`.
        """
        return cls(limit, np.clip(growth, -limit, limit), change)

    def values(self, growth: Floats, weight: float) -> Floats:
        """Return the penalty (..., k) of each log growth ratio ρ in `growth` (..., k).

        It is ``change * (ρ - wanted)² + weight * max(0, |ρ| - limit)²``, but linear in |ρ| far above `limit`.
        The preferred value `wanted`, `limit` and the factor `change` are fields of this object.
        """
        excess = np.maximum(np.abs(growth) - self.limit, 0.0)
        near = np.minimum(excess, LINEAR)
        return np.asarray(weight * near * (2.0 * excess - near) + self.change * (growth - self.wanted) ** 2)

    def residuals(self, growth: Floats, derivatives: Floats, weight: float) -> Residuals:
        """Return the penalty that `values` computes, linearised for a Gauss-Newton step.

        Each log growth ratio in `growth` (..., k) depends on m unknowns, with `derivatives` (..., k, m).
        """
        excess = np.maximum(np.abs(growth) - self.limit, 0.0)
        pull = weight * np.minimum(1.0, LINEAR / np.maximum(excess, LINEAR))
        stiffness = np.where(np.abs(growth) > self.limit - NEARLY, self.change + pull, self.change)
        slope = self.change * (growth - self.wanted) + pull * np.copysign(excess, growth)
        return Residuals(derivatives, stiffness, slope)


def damped(values: Callable[[Numbers], Floats], at: Numbers, step: Numbers, part: Indices) -> Numbers:
    """Return the changes `step` (m,) of m unknowns, halved as often as needed to decrease p functions.

    `values` computes the functions from the unknowns, which are now `at` (m,). Unknown i affects only the
    function ``part[i]``. Changes that affect the same function are halved together, and are 0 if it never
    decreases.
    """
    start = values(at)
    share = np.ones(len(start))
    for _ in range(HALVINGS):
        higher = ~(values(at + share[part] * step) < start)  # also NaN
        if not higher.any():
            return np.asarray(share[part] * step)
        share[higher] *= 0.5
    share[higher] = 0.0
    return np.asarray(share[part] * step)
