"""The place, turn and size of a domain taken out, so that the network need not learn them."""

from __future__ import annotations

from typing import Any


def frame(z: Any, xp: Any) -> tuple[Any, Any]:
    """Return the middle (batch,) of grids `z` (batch, n, n), complex, and the factor (batch,) to unit size.

    ``(z - middle) * factor`` has its outline's area 1, and its mean step from west to east and, turned by a
    quarter, from south to north points along x. The eight relabellings of a domain have the same frame,
    relabelled. Compiled for planes it is `kernels/neural/frame.c`.

    Parameters
    ----------
    z : array of numpy or of torch; only its rim is looked at.
    xp : the module, numpy or torch, that `z` is of.
    """
    south, north, west, east = z[:, :, 0], z[:, :, -1], z[:, 0], z[:, -1]
    outline = xp.concatenate(
        [south[:, :-1], east[:, :-1], xp.flip(north[:, 1:], (1,)), xp.flip(west[:, 1:], (1,))], 1
    )
    middle = outline.mean(1)
    outline = outline - middle[:, None]
    after = xp.concatenate([outline[:, 1:], outline[:, :1]], 1)
    area = 0.5 * (outline.conj() * after).imag.sum(1)
    towards = east.mean(1) - west.mean(1) - 1j * (north.mean(1) - south.mean(1))
    return middle, towards.conj() / abs(towards) / xp.sqrt(area)
