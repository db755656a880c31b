"""The nodes of a row: in space, and beside the blade in (s, theta, h) with theta = atan2(y, z)."""

from __future__ import annotations

from dataclasses import dataclass

from meshonet.geometry.arrays import Floats


@dataclass(frozen=True, eq=False)
class RowNodes:
    """Nodes of all levels.

    Parameters
    ----------
    space : (levels, n, 3) x, y, z.
    beside : (levels, k, 2, 3) s, theta, h of each node of the blade, clockwise, and of the node next to it.
    """

    space: Floats
    beside: Floats
