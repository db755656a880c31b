"""How far inside the mismatch between coarse edges and full ones is blended.

Between the nodes of a coarse edge the full one has detail. A smooth grid forgets detail of the size of a
coarse step within such a step, however thin the cells are along the edge; blended along whole lines, it
would fold thin cells far away. So at coarse node (i, j), at a distance d along its line from the edge ::

    share = max(0, 1 - d / r),    r = max(d_1, min(`REACH` h, length of the line))

with h the mean of the edge's steps to both sides of the line and d_1 the line's first cell. Between nodes
shares are linear.
"""

from __future__ import annotations

from typing import Any

REACH = 2.0  # steps of the edge over which its mismatch is blended


def inwards(planes: Any, xp: Any) -> tuple[Any, Any, Any, Any]:
    """Return shares (.., m, n) of south, north, west and east at the nodes of `planes` (.., 2, m, n).

    `xp`: numpy or torch.
    """
    south, north = _both(planes, xp)
    west, east = (xp.swapaxes(share, -1, -2) for share in _both(xp.swapaxes(planes, -1, -2), xp))
    return south, north, west, east


def _both(planes: Any, xp: Any) -> tuple[Any, Any]:
    """Return the shares of the first and of the last column."""
    x, y = planes[..., 0, :, :], planes[..., 1, :, :]
    along = xp.hypot(x[..., 1:] - x[..., :-1], y[..., 1:] - y[..., :-1])
    beside = xp.hypot(x[..., 1:, :] - x[..., :-1, :], y[..., 1:, :] - y[..., :-1, :])
    off = xp.cumsum(along, -1)
    off = xp.concatenate([xp.zeros_like(off[..., :1]), off], -1)
    whole = off[..., -1:]
    shares = []
    for away, first, step in (
        (off, along[..., :1], beside[..., :1]),
        (whole - off, along[..., -1:], beside[..., -1:]),
    ):
        before, after = (
            xp.concatenate([step[..., :1, :], step], -2),
            xp.concatenate([step, step[..., -1:, :]], -2),
        )
        way = xp.maximum(xp.minimum(0.5 * REACH * (before + after), whole), first)
        shares.append(xp.clip(1.0 - away / way, 0.0, 1.0))
    return shares[0], shares[1]
