"""What variational grids minimise: open angles, cells of even shape, lengths that change gradually.

With u and v the edges along xi and eta that meet at a corner of a cell, g = |u|², h = |v|², J = u × v,
l the lengths of the edges of one family, and at a cell's centre u and v the means of opposite edges::

    E = mean over cells of (mean over corners + 2 at the centre) / 3 of
            (1-w) (a g + h/a) / (2J) + w (g h / J²)²
      + β mean over cells of the squares of (ni-1) Δ_i log l and (nj-1) Δ_j log l, both families

The first term is the discrete harmonic functional: it is infinite at J = 0, so that a descent keeps a valid
grid valid. The second is 1/sin⁴ of the angle. Neither tells equal cells from stripes of alternating ones;
the third, the squared gradient of log l, does. Every mean is Simpson's or the trapezoidal rule over the unit
square, so that the minimum converges with the square of the step. Folded grids are minimised with
χ = (J + √(J² + ε²)) / 2 > 0 in place of J.

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
    """Weights of the terms."""

    shape: float = 0.97  # w, from 0 (harmonic) to 1 (angles only)
    # β. A fourth of the default is sharper, but buckles on strongly skewed domains.
    smoothness: float = 2.5e-3


AROUND = Weights(smoothness=2e-5)
"""Around a body, where cells grow by orders of magnitude: more smoothness would cost angles."""

WAKE = Weights(smoothness=3e-5)
"""Around a body and its wake: with less, rows grow threefold from one to the next, with more angles widen."""


def value(nodes: Floats, weights: Weights) -> float:
    """Return E of planar `nodes` (ni, nj, 2) of a quad, a number without unit; infinite when folded."""
    z = np.moveaxis(nodes, -1, 0)
    terms = aspect_of(nodes), weights.shape, weights.smoothness, 0.0, False, None
    return variational_energy(z, *terms, np.empty_like(z))[0]


def relief_of(wall: Floats) -> Floats:
    """Return the share of the angle term that corners at the nodes of a closed `wall` (ni, 2) keep, (ni,).

    Where the domain takes up more than 320 degrees around a node, as at a trailing edge, the two corners
    there cannot both be good; they keep sin⁴ of half that angle: like a right one at best.
    """
    half = 0.5 * (np.pi - turning(wall[:-1], closed=True))
    share = np.where(half > 8.0 / 9.0 * np.pi, (np.maximum(sin(half), 1e-3) ** 2) ** 2, 1.0)
    return np.append(share, share[0])


def aspect_of(nodes: Floats, periodic: bool = False) -> float:
    """Return a, the length of steps along eta over that of steps along xi, for `nodes` (ni, nj, 2).

    It is the ratio of the root mean square steps of west and east and of south and north. With `periodic`
    west and east are no boundary, and it is the a with the least harmonic term.
    """
    if periodic:
        u, v = np.diff(nodes, axis=0)[:, :-1], np.diff(nodes, axis=1)[:-1]
        area = np.abs(cross2(u, v))
        return float(np.sqrt(((v**2).sum(axis=-1) / area).mean() / ((u**2).sum(axis=-1) / area).mean()))
    walls, sides = nodes[:, :: nodes.shape[1] - 1], nodes[:: nodes.shape[0] - 1]
    along, across = walls[1:] - walls[:-1], sides[:, 1:] - sides[:, :-1]
    return float(np.sqrt((across**2).mean() / (along**2).mean()))
