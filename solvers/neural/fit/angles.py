"""The cells' included angles of a batch of grids in torch, as parts of a loss."""

from __future__ import annotations

import math

import torch
from torch import Tensor

NARROW, WIDE = math.radians(2.0), math.radians(172.0)  # angles beyond which a cell is taken to begin to fold
SLIGHT = 0.05  # radians beyond: with less, a cell counts in proportion, with more, by its logarithm
TINY = 1e-20  # area added where an edge is a point, so that its angle has a derivative


def excess(z: Tensor, goal: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return by how much grids `z` (batch, m, n) are worse than `goal`, of the same shape, both complex.

    Returns
    -------
    tuple
        of (batch,): the mean of the cells' largest included angles less the goal's, and the largest of them
        less the goal's, in radians, 0 where they are smaller; and the logarithm of how far cells fold, or
        nearly so, where the goal's do not.
    """
    least, most = extremes(z)
    with torch.no_grad():
        low, high = extremes(goal)
    mean = torch.relu((most - high).mean((1, 2)))
    widest = torch.relu(most.amax((1, 2)) - high.amax((1, 2)))
    folded = torch.relu(most - high.clamp(min=WIDE)) + torch.relu(low.clamp(max=NARROW) - least)
    return mean, widest, torch.log1p(folded.sum((1, 2)) / SLIGHT)


def extremes(z: Tensor) -> tuple[Tensor, Tensor]:
    """Return the smallest and the largest included angle of each cell (batch, m - 1, n - 1), in radians.

    Those of folded corners go on below 0, to -90 degrees, and above 180, so that the way back is uphill.
    """
    u, v = z.diff(dim=1), z.diff(dim=2)
    south, north, west, east = u[:, :, :-1], u[:, :, 1:], v[:, :-1], v[:, 1:]
    corners = ((south, west), (east, -south), (-north, -east), (-west, north))
    angles = torch.stack([_angle(p, q) for p, q in corners])
    return angles.amin(0), angles.amax(0)


def _angle(u: Tensor, v: Tensor) -> Tensor:
    """Return the angle from u to v, from -90 to 270 degrees."""
    product = u.conj() * v
    angle = torch.atan2(product.imag, product.real + TINY)
    return torch.where(angle < -0.5 * math.pi, angle + 2.0 * math.pi, angle)
