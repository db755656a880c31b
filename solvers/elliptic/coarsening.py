"""One direction of a grid, finer and coarser: difference weights and transfers between levels.

The coarse nodes are every second one and the last, whatever the count. The last coarse step is then shorter
than the others when the count of cells is odd, so every level carries its own node positions::

    fine    0   1   2   3   4   5   6   7        seven cells
    coarse  0       1       2       3   4        four cells, the last half as long
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from geometry.arrays import Floats


@dataclass(frozen=True, eq=False)
class Direction:
    """Positions (n,) of the nodes of one direction, in finest steps; `periodic`: the last node is the first.

    Examples
    --------
    >>> Direction(np.arange(8.0), periodic=False).coarse().positions
    array([0., 2., 4., 6., 7.])
    """

    positions: Floats
    periodic: bool

    @property
    def cells(self) -> int:
        """Cells along the direction."""
        return len(self.positions) - 1

    def kept(self) -> NDArray[np.intp]:
        """Return the indices of the nodes that the next coarser level keeps."""
        return np.minimum(2 * np.arange((self.cells + 1) // 2 + 1), self.cells)

    def coarse(self) -> Direction:
        """Return the next coarser direction."""
        return Direction(self.positions[self.kept()], self.periodic)

    def differences(self) -> tuple[Floats, Floats, Floats]:
        """Return the weights (forward, backward, centred) at each node, (n,) each.

        With steps h₋, h₊ around node k: x″ = 2/(h₋+h₊) [(x₊-x)/h₊ + (x₋-x)/h₋] and x′ = (x₊-x₋)/(h₋+h₊).
        """
        before, after = self._steps()
        both = before + after
        return 2.0 / (both * after), 2.0 / (both * before), 1.0 / both

    def reach(self) -> Floats:
        """Return the longer of the two steps at each node, (n,)."""
        return np.maximum(*self._steps())

    def transfer(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return the weights (right (n,); before, at, after (coarse n,)) of interpolation and restriction.

        Interpolation is linear; restriction is its transpose, scaled by the lengths that nodes stand for,
        so that a constant residual stays what it is.
        """
        before, after = self._steps()
        length = (before + after) / 2
        coarse_before, coarse_after = self.coarse()._steps()
        share = 2.0 / (coarse_before + coarse_after)
        kept, n = self.kept(), self.cells
        dropped = np.ones(n + 1, dtype=bool)
        dropped[kept] = False
        right = np.where(dropped, before / (before + after), 0.0)
        west = np.where(kept > 0, kept - 1, n - 1)
        east = np.where(kept < n, kept + 1, 1)
        to_west = np.where(dropped[west], right[west] * length[west], 0.0) * share
        to_east = np.where(dropped[east], (1.0 - right[east]) * length[east], 0.0) * share
        if not self.periodic:
            to_west[0] = to_east[-1] = 0.0
        return right, to_west, length[kept] * share, to_east

    def _steps(self) -> tuple[Floats, Floats]:
        """Return the steps before and after each node; at the ends, around the seam or mirrored."""
        h = np.diff(self.positions)
        first, last = (h[-1], h[0]) if self.periodic else (h[0], h[-1])
        return np.concatenate([[first], h]), np.concatenate([h, [last]])
