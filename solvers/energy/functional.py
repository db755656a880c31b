"""What the variational grid minimises, in plain numpy: the reference of the compiled `variational_energy`.

With u and v the edges along xi and eta that meet at a corner of a cell, g = |u|², h = |v|², J = u × v,
l the lengths of the edges of one family, and at a cell's centre u and v the means of opposite edges::

    E = mean over cells of (mean over corners + 2 at the centre) / 3 of
            (1-w) (a g + h/a) / (2J) + w (g h / J²)²
      + β mean over cells of the squares of (ni-1) Δ_i log l and (nj-1) Δ_j log l, both families

The first term is the discrete harmonic functional, whose barrier at J = 0 no continuous descent crosses, so
that a valid grid stays valid. The second is 1/sin⁴ of the angle. They alone have no minimum that a
finer grid would share: stripes of cells that alternate are as cheap as equal ones. The third, the square of
the gradient of log l, rules them out. Every mean is Simpson's or the trapezoidal rule over the unit square,
so that the minimum converges with the square of the step.

Ivanenko, Charakch'yan, USSR Comput. Maths. Math. Phys. 28 (1988) 126-133 (the barrier); Garanzha, Comput.
Maths. Math. Phys. 40 (2000) 1617-1637 (regularisation).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats


@dataclass(frozen=True)
class Weights:
    """What counts how much.

    Parameters
    ----------
    shape : w, from 0 (harmonic) to 1 (angles only).
    smoothness : β. A fourth of the default is sharper, but buckles on strongly skewed domains.
    """

    shape: float = 0.97
    smoothness: float = 2.5e-3


AROUND = Weights(smoothness=2e-5)
"""Around a body, where cells grow by orders of magnitude: more smoothness would cost angles."""

WAKE = Weights(smoothness=3e-5)
"""Around a body and its wake: with less, rows grow threefold from one to the next, with more angles widen."""


def energy(
    nodes: Floats, aspect: float, weights: Weights, epsilon: float = 0.0, *, periodic: bool = False
) -> float:
    """Return E of `nodes` (ni, nj, 2), a number without unit; infinite when folded and not regularised.

    Parameters
    ----------
    aspect : a, the length that steps along eta are to have over that of steps along xi.
    epsilon : an area; J is replaced by χ = (J + √(J² + ε²)) / 2, which is positive.
    periodic : the last row of nodes is the first.
    """
    u, v = np.diff(nodes, axis=0), np.diff(nodes, axis=1)
    south, north, west, east = u[:, :-1], u[:, 1:], v[:-1], v[1:]
    if epsilon == 0 and min(_cross(p, q).min() for p in (south, north) for q in (west, east)) <= 0:
        return float("inf")
    corners = [_density(p, q, aspect, weights, epsilon) for p in (south, north) for q in (west, east)]
    centre = _density(0.5 * (south + north), 0.5 * (west + east), aspect, weights, epsilon)
    cells = centre.size
    lengths = (_roughness(0.5 * np.log((edges**2).sum(axis=-1)), nodes, periodic) for edges in (u, v))
    return float((np.mean(corners) + 2.0 * centre.mean()) / 3.0 + weights.smoothness * sum(lengths) / cells)


def _density(u: Floats, v: Floats, aspect: float, weights: Weights, epsilon: float) -> Floats:
    """Return the harmonic and the angle term where edges `u` and `v` (..., 2) meet."""
    jacobian = _cross(u, v)
    if epsilon > 0:
        jacobian = 0.5 * (jacobian + np.sqrt(jacobian**2 + epsilon**2))
    g, h = (u**2).sum(axis=-1), (v**2).sum(axis=-1)
    harmonic = (aspect * g + h / aspect) / (2 * jacobian)
    angle = (g * h / jacobian**2) ** 2
    return np.asarray((1 - weights.shape) * harmonic + weights.shape * angle)


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def _roughness(log_length: Floats, nodes: Floats, periodic: bool) -> float:
    """Return the sum over the edges of one family, those along the rim halved, of the squared gradient."""
    ni, nj = nodes.shape[:2]
    along_xi = log_length.shape[0] == ni - 1
    squares_j = (nj - 1) ** 2 * np.diff(log_length, axis=1) ** 2
    if along_xi and periodic:
        log_length = np.concatenate([log_length, log_length[:1]])
    squares_i = (ni - 1) ** 2 * np.diff(log_length, axis=0) ** 2
    if along_xi:
        squares_i[:, [0, -1]] *= 0.5
    else:
        squares_j[[0, -1]] *= 0.5
    return float(squares_i.sum() + squares_j.sum())


def relief_of(wall: Floats) -> Floats:
    """Return the share of the angle term that corners at the nodes of a closed `wall` (ni, 2) keep, (ni,).

    Where the domain takes up more than 320 degrees around a node, as at a trailing edge, the two corners
    there cannot both be good; they keep sin⁴ of half that angle: like a right one at best.
    """
    edges = np.diff(wall, axis=0)
    before = np.roll(edges, 1, axis=0)
    turn = np.arctan2(_cross(before, edges), (before * edges).sum(axis=-1))
    half = 0.5 * (np.pi - turn)
    share = np.where(half > 8.0 / 9.0 * np.pi, np.maximum(np.sin(half), 1e-3) ** 4, 1.0)
    return np.append(share, share[0])


def aspect_of(nodes: Floats, periodic: bool = False) -> float:
    """Return a of `nodes` (ni, nj, 2): root mean square step of west and east over that of south and north.

    With `periodic` west and east are no boundary, and it is the a with the least harmonic term.
    """
    if periodic:
        u, v = np.diff(nodes, axis=0)[:, :-1], np.diff(nodes, axis=1)[:-1]
        area = np.abs(_cross(u, v))
        return float(np.sqrt(((v**2).sum(axis=-1) / area).mean() / ((u**2).sum(axis=-1) / area).mean()))
    walls, sides = nodes[:, :: nodes.shape[1] - 1], nodes[:: nodes.shape[0] - 1]
    along, across = walls[1:] - walls[:-1], sides[:, 1:] - sides[:, :-1]
    return float(np.sqrt((across**2).mean() / (along**2).mean()))
