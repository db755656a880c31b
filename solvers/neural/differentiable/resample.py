"""Interpolation with gradients: `algebraic.resample.quad` in torch."""

from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.arrays import Floats, array_like
from meshonet.solvers.algebraic.resample import corner_damping as acute
from meshonet.solvers.algebraic.resample.quad import REACH, mended
from meshonet.solvers.algebraic.resample.spline import bending
from meshonet.solvers.neural.differentiable.transfinite import with_rim


def refined(coarse: Tensor, sides: tuple[Tensor, ...]) -> Tensor:
    """Return the nodes (batch, 2, ni, nj) inside `sides`, interpolated from `coarse` (batch, 2, m, n).

    `sides`: south, north (batch, 2, ni), west, east (batch, 2, nj).
    """
    nodes = _evaluated(coarse, sides)
    where = folded(nodes.detach()).nonzero()[:, 0]
    if len(where) == 0:
        return nodes
    few, some = coarse[where], tuple(side[where] for side in sides)
    straight = [
        mended(planes[0], planes[1:-1], planes[-1])
        for planes in zip(*(arrays(planes) for planes in (few, *some, nodes[where])), strict=True)
    ]
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
    """Return the blending weights (.., m, n) of south, north, west and east (`algebraic.resample.quad`).

    `planes` (.., 2, m, n) are the nodes.
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


def arrays(planes: Tensor) -> Any:
    """Return `planes` as a NumPy array in float64."""
    return planes.detach().cpu().double().contiguous().numpy()


def between(values: Tensor, n: int) -> Tensor:
    """Return `values` (..., m) interpolated linearly at n uniform places (..., n), as `spline.between`."""
    m = values.shape[-1]
    return values if m == n else values @ array_like(acute.linear(m, n), values, torch).mT
