"""The functional of variational grids: angles, cell shapes, and gradual changes of edge lengths.

Ivanenko, Charakch'yan, USSR Comput. Maths. Math. Phys. 28 (1988) 126-133 (the barrier); Garanzha, Comput.
Maths. Math. Phys. 40 (2000) 1617-1637 (regularisation).
"""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, cross2
from meshonet.geometry.elementary import sin
from meshonet.geometry.polygon.corners import turning
from meshonet.kernels._native import variational_energy


@dataclass(frozen=True)
class Weights:
    """Weights w and β of the functional E.

    In a grid of ni x nj nodes, u and v are the edges along xi and eta at a corner of a cell, or their means
    at its centre. Then g = |u|², h = |v|² and J = u × v. The number a is the mean of |v| in the whole grid
    divided by that of |u| (`aspect_of`). l is the length of an edge, and Δ_i log l the difference of log l
    between edges that are neighbours in index i::

        T = (1-w) (a g + h/a) / (2J) + w (g h / J²)²
        S = mean over cells of ((ni-1) Δ_i log l)² + ((nj-1) Δ_j log l)²
        E = mean over cells of (mean of T at corners + 2 T at the centre) / 3
          + β (S of the edges along xi + S of the edges along eta)

    The first term of T is the discrete harmonic functional, which is infinite at J = 0. The second is 1/sin⁴
    of the angle. S is the squared gradient of log l, which prevents alternately narrow and wide cells. While
    cells are folded, J is replaced by χ = (J + √(J² + ε²)) / 2 > 0, with an area ε that is reduced gradually.
    """

    shape: float = 0.97  # w, from 0 (harmonic) to 1 (angles only)
    # β. A fourth of the default is sharper, but buckles on strongly skewed domains.
    smoothness: float = 2.5e-3


AROUND = Weights(smoothness=2e-5)
"""Weights for O grids, whose cells grow by orders of magnitude; more smoothness would worsen angles."""

WAKE = Weights(smoothness=3e-5)
"""Weights for C grids. A smaller weight lets rows grow threefold from one to the next."""


def value(nodes: Floats, weights: Weights) -> float:
    """Return the variational functional of a four-sided grid (ni, nj, 2); infinite if cells are folded."""
    z = np.moveaxis(nodes, -1, 0)
    terms = aspect_of(nodes), weights.shape, weights.smoothness, 0.0, False, None
    return variational_energy(z, *terms, np.empty_like(z))[0]


def relief_of(wall: Floats) -> Floats:
    """Return factors (ni,) of the terms 1/sin⁴ of angles in the functional E, for a closed `wall` (ni, 2).

    Where the angle of the domain exceeds 320 degrees, as at a sharp trailing edge, the factor is sin⁴ of half
    this angle. If a grid line halves the angle, factor times term is then 1. Elsewhere the factor is 1.
    """
    half = 0.5 * (np.pi - turning(wall[:-1], closed=True))
    share = np.where(half > 8.0 / 9.0 * np.pi, (np.maximum(sin(half), 1e-3) ** 2) ** 2, 1.0)
    return np.append(share, share[0])


def aspect_of(nodes: Floats, periodic: bool = False) -> float:
    """Return the variational functional's aspect ratio: mean edge length along eta divided by that along xi.

    The means are root mean squares over boundary edges. If `periodic`, they are over all cells instead, each
    with the weight 1 / area.
    """
    if periodic:
        u, v = np.diff(nodes, axis=0)[:, :-1], np.diff(nodes, axis=1)[:-1]
        area = np.abs(cross2(u, v))
        return float(np.sqrt(((v**2).sum(axis=-1) / area).mean() / ((u**2).sum(axis=-1) / area).mean()))
    walls, sides = nodes[:, :: nodes.shape[1] - 1], nodes[:: nodes.shape[0] - 1]
    along, across = walls[1:] - walls[:-1], sides[:, 1:] - sides[:, :-1]
    return float(np.sqrt((across**2).mean() / (along**2).mean()))
