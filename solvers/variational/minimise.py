"""Descent of the variational functional: L-BFGS with a preconditioner.

Steps s and preconditioned changes z = P y of the gradient are the rows of one table, which an iteration reads
as a matrix: for products with the gradient and with its change, and for the new direction. The two-loop
recursion itself runs on the small tables of the products s·y and y·z.

Nocedal and Wright, Numerical Optimization (2006), algorithm 7.4; the form in products: Chen, Wang and Zhou,
NIPS 27 (2014).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Floats

Functional = Callable[[Floats, Floats], tuple[float, float]]
"""From z and room for the gradient to the value and the smallest corner Jacobian."""

PAIRS = 8
"""Steps that are remembered."""

TRIES = 25
"""Lengths of a step that are tried."""

IDLE = 3
"""Small changes in a row that count as standing still; one may come from a short step."""


@dataclass(frozen=True)
class Outcome:
    """How a descent ended: value, smallest corner Jacobian, iterations."""

    value: float
    smallest: float
    iterations: int


def minimise(
    functional: Functional,
    precondition: Callable[[Floats], Floats],
    z: Floats,
    *,
    still: float,
    most: int,
    reach: float,
) -> Outcome:
    """Descend from `z` (any shape, C-contiguous), in place.

    Parameters
    ----------
    functional, precondition : what to minimise, and the inverse of roughly its Hessian, symmetric.
    still : stop when no coordinate changes by more, `IDLE` times in a row.
    most : iterations at the most.
    reach : no coordinate changes by more than this in the first iteration.
    """
    memory = _Memory(z.size)
    gradient, trial, spare = np.empty_like(z), np.empty_like(z), np.empty_like(z)
    value, smallest = functional(z, gradient)
    steepest = precondition(gradient)
    idle = 0
    for done in range(most):
        direction = memory.direction(gradient.ravel(), steepest.ravel()).reshape(z.shape)
        slope = float(np.vdot(direction, gradient))
        if not slope < 0.0:
            memory.forget()
            direction = -steepest
            slope = float(np.vdot(direction, gradient))
            if not slope < 0.0:
                return Outcome(value, smallest, done)
        largest = max(direction.max(), -direction.min())
        factor = 1.0 if memory.count else min(1.0, reach / largest)
        for _ in range(TRIES):
            np.multiply(direction, factor, out=trial)
            trial += z
            found, low = functional(trial, spare)
            if found <= value + 1e-4 * factor * slope:
                break
            factor *= _shorter(found - value, factor * slope)
        else:
            return Outcome(value, smallest, done)
        z[...] = trial
        value, smallest = found, low
        turned = precondition(spare)
        direction *= factor
        memory.remember(direction.ravel(), (spare - gradient).ravel(), (turned - steepest).ravel())
        gradient, spare, steepest = spare, gradient, turned
        idle = idle + 1 if factor * largest < still else 0
        if idle == IDLE:
            return Outcome(value, smallest, done + 1)
    return Outcome(value, smallest, most)


def _shorter(rise: float, slope: float) -> float:
    """Return the factor to the minimum of the parabola through both values and the slope, .1 to .5."""
    if not np.isfinite(rise):
        return 0.5
    return float(np.clip(-0.5 * slope / (rise - slope), 0.1, 0.5))


class _Memory:
    """The last pairs: row 2k of the table is a step s, row 2k + 1 its z = P y; `_order` is k by age."""

    def __init__(self, size: int) -> None:
        self._table = np.empty((2 * PAIRS, size))
        self._sy = np.zeros((PAIRS, PAIRS))
        self._yz = np.zeros((PAIRS, PAIRS))
        self._order: list[int] = []

    @property
    def count(self) -> int:
        """Pairs held."""
        return len(self._order)

    def forget(self) -> None:
        """Drop all pairs."""
        self._order = []

    def direction(self, gradient: Floats, steepest: Floats) -> Floats:
        """Return -H g for the gradient g, given P g."""
        n = self.count
        if n == 0:
            return -steepest
        order = np.array(self._order)
        table = self._table[: 2 * n]
        products = table @ gradient
        s_g, z_g = products[2 * order], products[2 * order + 1]
        sy, yz = self._sy[np.ix_(order, order)], self._yz[np.ix_(order, order)]
        scale = sy[-1, -1] / yz[-1, -1]
        alpha, rest = np.zeros(n), np.zeros(n)
        for k in range(n - 1, -1, -1):
            alpha[k] = (s_g[k] - sy[k] @ alpha) / sy[k, k]
        from_start = scale * (z_g - yz @ alpha)
        for k in range(n):
            rest[k] = alpha[k] - (from_start[k] + rest @ sy[:, k]) / sy[k, k]
        share = np.empty(2 * n)
        share[2 * order], share[2 * order + 1] = -rest, scale * alpha
        result = share @ table
        result -= scale * steepest
        return np.asarray(result)

    def remember(self, step: Floats, change: Floats, turned: Floats) -> None:
        """Add the step, the gradient's change y and P y, unless the functional bends down along the step."""
        curvature = float(step @ change)
        if not curvature > 1e-12 * np.sqrt(float(step @ step) * float(change @ change)):
            return
        slot = self.count if self.count < PAIRS else self._order.pop(0)
        self._order.append(slot)
        self._table[2 * slot], self._table[2 * slot + 1] = step, turned
        order = np.array(self._order)
        products = self._table[: 2 * self.count] @ change
        self._sy[slot] = 0.0
        self._sy[order, slot] = products[2 * order]
        self._yz[order, slot] = self._yz[slot, order] = products[2 * order + 1]
