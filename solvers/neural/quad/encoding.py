"""Inputs of the quad network and scaling of its outputs; `xp` is numpy or torch, the module of the arrays."""

from typing import Any

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.elementary import functions_of, modulus, times

LATENT = 33  # nodes along xi and eta of the network's input grid
SCALE = 0.1  # what an answer of 1 means, in the normalised domain's unit
HEADS = ("winslow", "variational")  # the grids that a network's outputs approximate, in order
WINSLOW = 0  # the first of these, which takes a few steps of `picard.approach` after the network

FEATURES = 20
"""Channels per node: first differences (4), second differences (4), logarithms of the lengths of both steps
(2), position (2), cosine and sine of the angle between the steps (2), inverse hyperbolic sine of the Jacobian
(1), xi and eta (2), the last step of `approach` divided by its size (2), and the logarithm of this size (1).
"""

FLOOR = 1e-2  # added to lengths before their logarithm

TINY = 1e-6  # keeps quotients and slopes of lengths finite where nodes coincide

STILL = 1e-3  # added to the size of the last step
STRETCH = 30.0  # factor of small Picard steps in the inverse hyperbolic sine


def frame(z: Any, xp: Any) -> tuple[Any, Any]:
    """Return for each grid `z` (batch, n, n) of nodes x + iy its centre (batch,) and a factor (batch,).

    The grid ``(z - centre) * factor`` has area 1. The complex factor also turns it, so that on average xi is
    along x and eta along y.
    """
    south, north, west, east = z[:, :, 0], z[:, :, -1], z[:, 0], z[:, -1]
    outline = xp.concatenate(
        [south[:, :-1], east[:, :-1], xp.flip(north[:, 1:], (1,)), xp.flip(west[:, 1:], (1,))], 1
    )
    middle = outline.mean(1)
    outline = outline - middle[:, None]
    after = xp.concatenate([outline[:, 1:], outline[:, :1]], 1)
    area = 0.5 * times(outline.conj(), after).imag.sum(1)
    towards = east.mean(1) - west.mean(1) - 1j * (north.mean(1) - south.mean(1))
    return middle, towards.conj() / modulus(towards) / xp.sqrt(area)


def planes_of(z: Complexes) -> Floats:
    """Return the coordinates x and y (batch, 2, m, n) of complex grids `z` (batch, m, n)."""
    return np.ascontiguousarray(np.stack([z.real, z.imag], axis=1))


def features(z: Any, step: Any, xp: Any, around: bool = False) -> Any:
    """Return the network's inputs (batch, n, n, FEATURES) for normalised complex grids `z` (batch, n, n).

    `step` (batch, n, n) is the last Picard step (see `picard.approach`). With `around`, `z`
    (batch, m + 1, n) are O grids mapped to periodic strips by i log(z - centre), so that the last line of n
    nodes is the first plus one period. The result then has the shape (batch, m, n, FEATURES).
    """
    n = z.shape[-1]
    if around:
        u, a, z, where = _round(z, xp)
        step = step[:, :-1]
    else:
        u, a, where = _slope(z, xp), _bend(z, xp), z
    v, b = _slope(z.swapaxes(1, 2), xp).swapaxes(1, 2), _bend(z.swapaxes(1, 2), xp).swapaxes(1, 2)
    call, product, lengths = functions_of(xp), times(u.conj(), v), (modulus(u), modulus(v))
    angle = product / (lengths[0] * lengths[1] + TINY)
    place = xp.linspace(-1.0, 1.0, n, dtype=z.real.dtype, device=z.device) + 0.0 * z.real
    along = 0.0 * place if around else place.swapaxes(1, 2)
    squares = step.real**2 + step.imag**2
    size = xp.sqrt(squares.mean((1, 2)) + TINY**2)[:, None, None] + STILL
    length = xp.sqrt(squares + TINY**2) / size
    step = step * (call.arcsinh(STRETCH * length) / (2.0 * size * length))
    channels = (
        u.real, v.real, u.imag, v.imag, a.real, b.real, a.imag, b.imag,
        call.log(lengths[0] + FLOOR), call.log(lengths[1] + FLOOR), where.real, where.imag,
        angle.real, angle.imag, call.arcsinh(product.imag), along, place,
        step.real, step.imag, call.log10(size) + 2.0 + 0.0 * place,
    )  # fmt: skip
    return xp.stack(channels, -1)


def _round(z: Any, xp: Any) -> tuple[Any, Any, Any, Any]:
    """Return first and second differences, places, places minus equal steps (batch, m, n) of strips `z`."""
    cells, m = z.shape[2] - 1, z.shape[1] - 1
    turn = z[:, -1:, :1] - z[:, :1, :1]
    ring = xp.concatenate([z[:, -2:-1] - turn, z], 1)
    inner = z[:, :-1]
    slope = 0.5 * cells * (ring[:, 2:] - ring[:, :-2])
    bend = 2 * cells * (ring[:, 2:] + ring[:, :-2] - 2.0 * inner)
    steps = xp.arange(m, dtype=z.real.dtype, device=z.device)[:, None] / m
    where = inner - turn * steps
    return slope, bend, inner, where - where.mean((1, 2))[:, None, None]


def _slope(z: Any, xp: Any) -> Any:
    """Return central differences along axis 1, one-sided at the ends, per unit of xi."""
    ends = z[:, 1:2] - z[:, :1], z[:, -1:] - z[:, -2:-1]
    return (z.shape[1] - 1) * xp.concatenate([ends[0], 0.5 * (z[:, 2:] - z[:, :-2]), ends[1]], 1)


def _bend(z: Any, xp: Any) -> Any:
    """Return second differences along axis 1, zero at the ends, times twice the cells."""
    inner = z[:, 2:] + z[:, :-2] - 2.0 * z[:, 1:-1]
    nothing = 0.0 * z[:, :1]
    return 2 * (z.shape[1] - 1) * xp.concatenate([nothing, inner, nothing], 1)
