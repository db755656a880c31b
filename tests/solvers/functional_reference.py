"""The functional of variational grids in plain numpy, against which the compiled one is tested."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.energy.functional import Weights


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
