"""The nodes of a row, level by level along the span: in space, and next to the blade in (s, theta, h).

theta is atan2(y, z): the directions of s, theta and h are then right-handed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.rows.channel import Channel


@dataclass(frozen=True, eq=False)
class RowNodes:
    """Nodes of all levels.

    Parameters
    ----------
    space : (levels, n, 3) x, y, z.
    beside : (levels, k, 2, 3) s, theta, h of the nodes of the blade, clockwise around it, and those next to
        them.
    """

    space: Floats
    beside: Floats


def in_space(channel: Channel, values: Floats) -> Floats:
    """Return x, y, z (..., 3) of s, theta, h (..., 3)."""
    x_r = channel.at(values[..., 0], values[..., 2])
    theta, out = values[..., 1], np.empty(values.shape)
    out[..., 0] = x_r[..., 0]
    out[..., 1], out[..., 2] = x_r[..., 1] * sin(theta), x_r[..., 1] * cos(theta)
    return out
