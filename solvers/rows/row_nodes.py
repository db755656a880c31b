"""The nodes of a row: in space, and beside the blade in (s, theta, h) with theta = atan2(y, z)."""

from __future__ import annotations

from dataclasses import dataclass

from meshonet.geometry.arrays import Floats


@dataclass(frozen=True, eq=False)
class RowNodes:
    """Nodes of all levels."""

    space: Floats  # (levels, n, 3) x, y, z
    beside: Floats  # (levels, k, 2, 3) s, theta, h of the blade's nodes, clockwise, and of those next to them
