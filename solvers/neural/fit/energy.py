"""The variational functional of a batch of grids in torch, so that a network can be taught by it.

The same numbers as `solvers.variational.functional`, its reference.
"""

from __future__ import annotations

import torch
from torch import Tensor

from solvers.variational.functional import Weights

MOST = 1e6
"""What a corner counts at the most: one folded corner must not drown the batch."""

SMALLEST = 1e-12
"""Area: with less, a folded corner's derivatives would be infinite, and no clamp makes these finite."""


def energies(z: Tensor, epsilon: float, weights: Weights | None = None) -> Tensor:
    """Return E (batch,) of quad grids `z` (batch, n, n), complex.

    Parameters
    ----------
    epsilon : an area; J is replaced by (J + √(J² + ε²)) / 2, which is positive.
    """
    weights = weights or Weights()
    u, v = z.diff(dim=1), z.diff(dim=2)
    along = _squares(u[:, :, 0]).sum(1) + _squares(u[:, :, -1]).sum(1)
    across = _squares(v[:, 0]).sum(1) + _squares(v[:, -1]).sum(1)
    aspect = (across / along).sqrt()[:, None, None]
    south, north, west, east = u[:, :, :-1], u[:, :, 1:], v[:, :-1], v[:, 1:]
    corners = [_density(p, q, aspect, weights, epsilon) for p in (south, north) for q in (west, east)]
    centre = _density(0.5 * (south + north), 0.5 * (west + east), aspect, weights, epsilon)
    shape = (sum(corners) / 4.0 + 2.0 * centre) / 3.0
    roughness = _roughness(u) + _roughness(v.swapaxes(1, 2))
    return shape.mean((1, 2)) + weights.smoothness * roughness / centre[0].numel()


def _density(u: Tensor, v: Tensor, aspect: Tensor, weights: Weights, epsilon: float) -> Tensor:
    jacobian = (u.conj() * v).imag
    reach = jacobian.abs() + torch.sqrt(jacobian**2 + epsilon**2) + 1e-30
    jacobian = torch.where(jacobian > 0, 0.5 * reach, 0.5 * epsilon**2 / reach)  # no difference of equals
    jacobian = jacobian.clamp(min=SMALLEST)
    g, h = _squares(u), _squares(v)
    harmonic = (aspect * g + h / aspect) / (2.0 * jacobian)
    angle = (g * h / jacobian**2).clamp(max=MOST) ** 2
    return torch.clamp((1.0 - weights.shape) * harmonic + weights.shape * angle, max=MOST)


def _roughness(edges: Tensor) -> Tensor:
    """Return the sum of squared gradients of log lengths (batch,) of edges (batch, n-1, n) along axis 1."""
    n = edges.shape[2]
    log = 0.5 * torch.log(_squares(edges) + 1e-18)
    half = torch.ones(n, dtype=log.dtype, device=log.device)
    half[[0, -1]] = 0.5
    along, across = log.diff(dim=1).square() * half, log.diff(dim=2).square()
    return (n - 1) ** 2 * (along.sum((1, 2)) + across.sum((1, 2)))


def _squares(z: Tensor) -> Tensor:
    return z.real**2 + z.imag**2
