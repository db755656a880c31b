"""Interpolation with gradients: transfinite, and `algebraic.resample.quad` in torch."""

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Floats, array_like
from meshonet.solvers.algebraic.resample import corner_damping as acute
from meshonet.solvers.algebraic.resample.quad import REACH, mended
from meshonet.solvers.algebraic.resample.spline import bending
from meshonet.solvers.neural.differentiable.arguments import as_numpy

Sides = tuple[Tensor, ...]  # south, north (batch, 2, ni), west and east (batch, 2, nj)


def interpolated(sides: Sides, laws: tuple[Tensor, ...]) -> Tensor:
    """Return nodes (batch, 2, ni, nj) by transfinite interpolation between `sides`.

    `laws` has, for each side, the parameters (batch, n) of its nodes, from 0 to 1.
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
    """Return nodes (batch, 2, ni, nj): `inner` (batch, 2, ni-2, nj-2) surrounded by the nodes of `sides`."""
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


def refined(coarse: Tensor, sides: tuple[Tensor, ...]) -> Tensor:
    """Return the nodes (batch, 2, ni, nj) inside `sides`, interpolated from `coarse` (batch, 2, m, n).

    `sides` are south and north (batch, 2, ni), then west and east (batch, 2, nj).
    """
    nodes = _evaluated(coarse, sides)
    where = folded(nodes.detach()).nonzero()[:, 0]
    if len(where) == 0:
        return nodes
    few, some = coarse[where], tuple(side[where] for side in sides)
    members = (as_numpy(part.double().contiguous()) for part in (few, *some, nodes[where]))
    straight = [mended(planes, edges, grid) for planes, *edges, grid in zip(*members, strict=True)]
    curved = np.stack([np.ones(few.shape[2:]) if lines is None else 1.0 - lines for lines in straight])
    kept = array_like(curved, coarse, torch)
    return nodes.index_copy(0, where, _evaluated(few, some, kept[:, None]))


def _evaluated(coarse: Tensor, sides: tuple[Tensor, ...], curved: Tensor | None = None) -> Tensor:
    """Return grids interpolated with second derivatives scaled by `curved` (batch, 1, m, n), if given."""
    (m, n), ni, nj = coarse.shape[2:], sides[0].shape[-1], sides[2].shape[-1]

    def matrix(values: Floats) -> Tensor:
        table: Tensor = array_like(values, coarse, torch)
        return table

    opened = acute.openings(torch.complex(coarse[:, 0], coarse[:, 1]), torch).reshape(-1, 4, 1, 1)
    kept = 1.0 - (opened * matrix(acute.fading(m, n))).amax(1, keepdim=True)
    kept = kept if curved is None else kept * curved
    along, across = (matrix(bending(k, False)) for k in (m, n))
    low, line = matrix(acute.linear(m, ni)), matrix(acute.linear(n, nj))
    high, curve = matrix(acute.cubic(m, ni)), matrix(acute.cubic(n, nj))
    second = along @ coarse
    values = coarse @ line.mT + (kept * (coarse @ across.mT)) @ curve.mT
    bends = (kept * second) @ line.mT + (kept * (second @ across.mT)) @ curve.mT
    nodes = low @ values + high @ bends

    south, north, west, east = sides
    weights = [(low @ share @ line.mT)[:, None] for share in inwards(coarse)]
    missed = (west - nodes[:, :, 0])[:, :, None], (east - nodes[:, :, -1])[:, :, None]
    nodes = nodes + weights[2] * missed[0] + weights[3] * missed[1]
    missed = (south - nodes[..., 0])[..., None], (north - nodes[..., -1])[..., None]
    nodes = nodes + weights[0] * missed[0] + weights[1] * missed[1]
    return with_rim(sides, nodes[:, :, 1:-1, 1:-1])


def inwards(planes: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Return weights (.., m, n) for each side: south, north, west and east. They decay from 1 to 0 inwards.

    If a side is displaced, inner nodes move by these fractions. `planes` (.., 2, m, n) are x and y of nodes.
    """
    south, north = _both(planes)
    west, east = (share.mT for share in _both(planes.mT))
    return south, north, west, east


def _both(planes: Tensor) -> list[Tensor]:
    """Return the blending weights of the first and of the last column."""
    along, beside = (torch.hypot(*planes.diff(dim=axis).unbind(-3)) for axis in (-1, -2))
    off = torch.nn.functional.pad(along.cumsum(-1), (1, 0))
    whole, shares = off[..., -1:], []
    for away, first, step in (
        (off, along[..., :1], beside[..., :1]),
        (whole - off, along[..., -1:], beside[..., -1:]),
    ):
        mean = 0.5 * (torch.cat([step[..., :1, :], step], -2) + torch.cat([step, step[..., -1:, :]], -2))
        way = torch.maximum(torch.minimum(REACH * mean, whole), first)
        shares.append((1.0 - away / way).clip(0.0, 1.0))
    return shares


def folded(nodes: Tensor) -> Tensor:
    """Return a mask (batch,) of the grids (batch, 2, ni, nj) that have folded cells."""
    along, across = nodes[:, :, 1:] - nodes[:, :, :-1], nodes[..., 1:] - nodes[..., :-1]
    valid = torch.ones(len(nodes), dtype=torch.bool, device=nodes.device)
    for u in (along[..., :-1], along[..., 1:]):
        for v in (across[:, :, :-1], across[:, :, 1:]):
            valid &= (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] > 0).flatten(1).all(1)
    return ~valid


def between(values: Tensor, n: int) -> Tensor:
    """Interpolate `values` (..., m) linearly to `n` values; both are evenly spaced over the same range."""
    m = values.shape[-1]
    return values if m == n else values @ array_like(acute.linear(m, n), values, torch).mT
