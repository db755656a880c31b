"""The nodes of a row in (s, theta, h), level by level along the span, and their places in space.

theta is atan2(y, z): the directions of s, theta and h are then right-handed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.rows.channel import Channel


@dataclass(frozen=True, eq=False)
class RowNodes:
    """Nodes of all levels.

    Parameters
    ----------
    channel : Channel
        In which they are.
    values : (levels, n, 3) s, theta and h of each.
    """

    channel: Channel
    values: Floats

    def space(self, level: int | slice = slice(None), nodes: Indices | slice = slice(None)) -> Floats:
        """Return x, y, z (..., 3) of the nodes of levels."""
        return in_space(self.channel, self.values[level][..., nodes, :])


def in_space(channel: Channel, values: Floats) -> Floats:
    """Return x, y, z (..., 3) of s, theta, h (..., 3)."""
    x_r = channel.at(values[..., 0], values[..., 2])
    theta, out = values[..., 1], np.empty(values.shape)
    out[..., 0] = x_r[..., 0]
    out[..., 1], out[..., 2] = x_r[..., 1] * sin(theta), x_r[..., 1] * cos(theta)
    return out
