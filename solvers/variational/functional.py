"""What the variational grid minimises, in plain numpy: the reference of the compiled `_variational`.

With u and v the edges along xi and eta that meet at a corner of a cell, g = |u|², h = |v|², J = u × v,
and l the lengths of the edges of one family::

    E = mean over corners [ (1-w) (a g + h/a) / (2J) + w (g h / J²)² ]
      + β Σ over both families of the mean over edges [ ((ni-1) Δ_i log l)² + ((nj-1) Δ_j log l)² ]

The first term is the discrete harmonic functional, whose barrier at J = 0 no continuous descent crosses, so
that a valid grid stays valid. The second is 1/sin⁴ of the corner's angle. They alone have no minimum that a
finer grid would share: stripes of cells that alternate are as cheap as equal ones. The third, the square of
the gradient of log l, rules them out.

Ivanenko, Charakch'yan, USSR Comput. Maths. Math. Phys. 28 (1988) 126-133 (the barrier); Garanzha, Comput.
Maths. Math. Phys. 40 (2000) 1617-1637 (regularisation).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Floats


@dataclass(frozen=True)
class Weights:
    """What counts how much.

    Parameters
    ----------
    shape : w, from 0 (harmonic) to 1 (angles only).
    smoothness : β. A fourth of the default is sharper, but buckles on strongly skewed domains.
    """

    shape: float = 0.9
    smoothness: float = 2e-3


def energy(nodes: Floats, aspect: float, weights: Weights, epsilon: float = 0.0) -> float:
    """Return E of `nodes` (ni, nj, 2), a number without unit; infinite when folded and not regularised.

    Parameters
    ----------
    aspect : a, the length that steps along eta are to have over that of steps along xi.
    epsilon : an area; J is replaced by χ = (J + √(J² + ε²)) / 2, which is positive.
    """
    u, v = np.diff(nodes, axis=0), np.diff(nodes, axis=1)
    corners = []
    for along in (u[:, :-1], u[:, 1:]):
        for across in (v[:-1], v[1:]):
            jacobian = along[..., 0] * across[..., 1] - along[..., 1] * across[..., 0]
            g, h = (along**2).sum(axis=-1), (across**2).sum(axis=-1)
            if epsilon > 0:
                jacobian = 0.5 * (jacobian + np.sqrt(jacobian**2 + epsilon**2))
            elif jacobian.min() <= 0:
                return float("inf")
            harmonic = (aspect * g + h / aspect) / (2 * jacobian)
            angle = (g * h / jacobian**2) ** 2
            corners.append(((1 - weights.shape) * harmonic + weights.shape * angle).mean())
    lengths = sum(_roughness(0.5 * np.log((edges**2).sum(axis=-1)), nodes.shape) for edges in (u, v))
    return float(np.mean(corners) + weights.smoothness * lengths)


def _roughness(log_length: Floats, shape: tuple[int, ...]) -> float:
    """Return the mean over edges of the squared gradient of `log_length`."""
    total = 0.0
    for axis in (0, 1):
        total += ((shape[axis] - 1) ** 2 * np.diff(log_length, axis=axis) ** 2).sum()
    return float(total / log_length.size)


def aspect_of(nodes: Floats) -> float:
    """Return a of `nodes` (ni, nj, 2): root mean square step of west and east over south and north."""
    along = np.concatenate([np.diff(nodes[:, j], axis=0) for j in (0, -1)])
    across = np.concatenate([np.diff(nodes[i], axis=0) for i in (0, -1)])
    return float(np.sqrt((across**2).sum(axis=-1).mean() / (along**2).sum(axis=-1).mean()))
