"""How far to march so that the last level is as far out as the far field: less where lines spread."""

from __future__ import annotations

import math

import numpy as np

from meshonet.solvers.hyperbolic.front import Front
from meshonet.solvers.hyperbolic.level_spacing import Edge, level_steps
from meshonet.solvers.hyperbolic.settings import RISING, MarchSettings

_CLOSED_AHEAD, _OPEN_BEHIND = 1.8, 0.26
"""By how much, as a part, levels around slender bodies come out farther than around a circle, over
slenderness and the square of the rate at which steps grow; and levels of C grids less far than two straight
sides and half a circle, over that rate. Measured on airfoils, where it leaves half a percent."""


def distance_to_march(
    front: Front, first: float, cells: int, settings: MarchSettings, constant: int, edge: Edge | None
) -> float:
    """Return the sum of the steps that lead from the radius of the body to that of the far field.

    Around a circle of n nodes a step s leads from r to r + s (1 - e)/(1 + f s/r + 2 e s/r): f is the weight
    of the flux along a level, e = 2π ε q/n + b h/r the dissipation, q what is left of it where lines spread.
    Along the straight sides of a C it leads to r + s. Airfoils are no circles: `_CLOSED_AHEAD` and
    `_OPEN_BEHIND`.
    """
    distance = front.outer - front.inner
    around = 2.0 * math.pi * settings.dissipation / len(front.start())
    powers = (2.0 / np.sqrt(np.minimum(np.arange(cells) + 1.0, round(RISING * cells)) / cells)).tolist()
    for _ in range(8):
        before = r = front.inner
        height = 0.0
        steps = level_steps(first, distance, cells, constant, edge).tolist()
        for step, power in zip(steps, powers, strict=True):
            height += step
            slow = min(around * max((before / r) ** power, 0.1) + settings.bend * height / r, 0.1)
            part = step * (1.0 - slow) / (1.0 + (1.0 + settings.theta + 2.0 * slow) * step / r)
            curved, before = front.curved(r), r
            r += curved * part + (1.0 - curved) * step
        if abs(r - front.outer) < 3e-3 * front.outer:
            break
        distance *= (front.outer - front.inner) / (r - front.inner)
    rate = math.log(steps[-1] / steps[-2]) if cells > 1 else 0.0
    if front.ends is not None:
        return distance * (1.0 + _OPEN_BEHIND * rate)
    return distance * (1.0 - min(_CLOSED_AHEAD * front.slender * rate**2, 0.1))
