"""What the quad network sees at every node: the transfinite grid, its steps and their changes."""

from __future__ import annotations

from typing import Any

FEATURES = 17
"""Channels a node: first differences (4), second differences (4), log lengths of both steps (2), place (2),
cosine and sine between the steps (2), the Jacobian's inverse hyperbolic sine (1), xi and eta (2)."""

FLOOR = 1e-2
"""Added to lengths before their logarithm."""

TINY = 1e-6


def features(z: Any, xp: Any) -> Any:
    """Return (batch, n, n, FEATURES) of normalised grids `z` (batch, n, n), complex.

    Parameters
    ----------
    z : array of numpy or of torch.
    xp : the module, numpy or torch, that `z` is of.

    The order is that of `symmetry.SEEN`.
    """
    n = z.shape[-1]
    u, v = _slope(z, xp), _slope(z.swapaxes(1, 2), xp).swapaxes(1, 2)
    a, b = _bend(z, xp), _bend(z.swapaxes(1, 2), xp).swapaxes(1, 2)
    product, lengths = u.conj() * v, (abs(u), abs(v))
    angle = product / (lengths[0] * lengths[1] + TINY)
    place = xp.linspace(-1.0, 1.0, n, dtype=z.real.dtype) + 0.0 * z.real
    channels = (
        u.real, v.real, u.imag, v.imag, a.real, b.real, a.imag, b.imag,
        xp.log(lengths[0] + FLOOR), xp.log(lengths[1] + FLOOR), z.real, z.imag,
        angle.real, angle.imag, xp.arcsinh(product.imag), place.swapaxes(1, 2), place,
    )  # fmt: skip
    return xp.stack(channels, -1)


def _slope(z: Any, xp: Any) -> Any:
    """Return central differences along axis 1, one-sided at the ends, per unit of xi."""
    ends = z[:, 1:2] - z[:, :1], z[:, -1:] - z[:, -2:-1]
    return (z.shape[1] - 1) * xp.concatenate([ends[0], 0.5 * (z[:, 2:] - z[:, :-2]), ends[1]], 1)


def _bend(z: Any, xp: Any) -> Any:
    """Return second differences along axis 1, zero at the ends, times twice the cells."""
    inner = z[:, 2:] + z[:, :-2] - 2.0 * z[:, 1:-1]
    nothing = 0.0 * z[:, :1]
    return 2 * (z.shape[1] - 1) * xp.concatenate([nothing, inner, nothing], 1)
