"""Transfinite interpolation of batches in torch, as `meshonet.solvers.algebraic.tfi`."""

import torch
from torch import Tensor

Sides = tuple[Tensor, ...]  # south, north (batch, 2, ni), west and east (batch, 2, nj)


def interpolated(sides: Sides, laws: tuple[Tensor, ...]) -> Tensor:
    """Return nodes (batch, 2, ni, nj) by transfinite interpolation between `sides`.

    `laws`: parameters of the nodes on the four sides, 0 to 1, (batch, n) each.
    """
    south, north, west, east = sides
    s, n = (law[:, 1:-1, None] for law in laws[:2])
    w, e = (law[:, None, 1:-1] for law in laws[2:])
    u = (s + (n - s) * w) / (1.0 - (n - s) * (e - w))
    v = (w + (e - w) * u)[:, None]
    u = u[:, None]
    a, b, c, d = (side[:, :, k, None, None] for side, k in ((south, 0), (south, -1), (north, -1), (north, 0)))
    left = west[:, :, None, 1:-1] - a - v * (d - a)
    right = east[:, :, None, 1:-1] - b - v * (c - b)
    low, high = south[:, :, 1:-1, None], north[:, :, 1:-1, None]
    inner = low + v * (high - low) + left + u * (right - left)
    return with_rim(sides, inner)


def with_rim(sides: Sides, inner: Tensor) -> Tensor:
    """Return nodes (batch, 2, ni, nj): the nodes `inner` (batch, 2, ni-2, nj-2) with `sides` around them."""
    south, north, west, east = sides
    rows = torch.cat([south[:, :, 1:-1, None], inner, north[:, :, 1:-1, None]], 3)
    return torch.cat([west[:, :, None], rows, east[:, :, None]], 2)


def arc_lengths(sides: Sides) -> tuple[Tensor, ...]:
    """Return the arc length (batch, n) of the nodes along each side, from 0 to 1."""
    fractions = []
    for side in sides:
        steps = side[..., 1:] - side[..., :-1]
        still = (steps == 0).all(1)  # between equal nodes, where a length has no gradient
        moved = torch.where(still[:, None], torch.ones_like(steps), steps)
        along = torch.cumsum(torch.hypot(moved[:, 0], moved[:, 1]).masked_fill(still, 0.0), -1)
        fractions.append(torch.cat([torch.zeros_like(along[:, :1]), along / along[:, -1:]], -1))
    return tuple(fractions)
