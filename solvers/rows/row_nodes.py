"""The nodes of a row, level by level along the span: in space, and next to the blade in (s, theta, h).

theta is atan2(y, z): the directions of s, theta and h are then right-handed.
"""

from __future__ import annotations

from dataclasses import dataclass

from meshonet.geometry.arrays import Floats


@dataclass(frozen=True, eq=False)
class RowNodes:
    """Nodes of all levels.

    Parameters
    ----------
    space : (levels, n, 3) x, y, z.
    beside : (levels, k, 2, 3) for each node of the blade, clockwise: s, theta, h of this node and of the node
        next to it.
    """

    space: Floats
    beside: Floats
