"""Multigrid data of one index direction: finite-difference weights and transfers between levels."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats


@dataclass(frozen=True, eq=False)
class Direction:
    """One index direction of a multigrid level: node positions (n,), in steps of the finest level.

    The next coarser level keeps every second node and the last node, so that its last step may be shorter. If
    `periodic`, the last node is the first.

    >>> Direction(np.arange(8.0), periodic=False).coarse.positions
    array([0., 2., 4., 6., 7.])
    """

    positions: Floats
    periodic: bool

    @property
    def cells(self) -> int:
        """Number of cells."""
        return len(self.positions) - 1

    @cached_property
    def kept(self) -> NDArray[np.intp]:
        """Indices of the nodes that the next coarser level keeps."""
        return np.minimum(2 * np.arange((self.cells + 1) // 2 + 1), self.cells)

    @cached_property
    def coarse(self) -> "Direction":
        """The same direction on the next coarser level."""
        return Direction(self.positions[self.kept], self.periodic)

    @cached_property
    def differences(self) -> tuple[Floats, Floats, Floats]:
        """Weights a, b, c of finite differences, each (n,), for steps h₋ and h₊ to a node's neighbours.

        a = 2/((h₋+h₊) h₊), b = 2/((h₋+h₊) h₋), c = 1/(h₋+h₊): x″ = a (x₊-x) + b (x₋-x), x′ = c (x₊-x₋).
        """
        before, after = self._steps
        both = before + after
        return 2.0 / (both * after), 2.0 / (both * before), 1.0 / both

    @cached_property
    def reach(self) -> Floats:
        """For each node (n,), the longer of the two steps to its neighbours."""
        return np.maximum(*self._steps)

    @cached_property
    def transfer(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Weights of linear interpolation (one array), and of restriction, its transpose (three arrays).

        The first array has for each fine node (n,) the weight of the coarse node after it, 0 at coarse nodes.
        The other arrays have for each coarse node the weights of the fine nodes before, at and after it,
        scaled by the lengths of the dual cells, so that a constant residual is preserved.
        """
        before, after = self._steps
        length = (before + after) / 2
        coarse_before, coarse_after = self.coarse._steps
        share = 2.0 / (coarse_before + coarse_after)
        kept, n = self.kept, self.cells
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

    @cached_property
    def _steps(self) -> tuple[Floats, Floats]:
        """Steps before and after each node; at the ends periodic or mirrored."""
        h = np.diff(self.positions)
        first, last = (h[-1], h[0]) if self.periodic else (h[0], h[-1])
        return np.concatenate([[first], h]), np.concatenate([h, [last]])


@lru_cache(maxsize=16)
def uniform(n: int, periodic: bool) -> Direction:
    """Return the `Direction` for n equally spaced nodes; it is cached."""
    return Direction(np.arange(float(n)), periodic)
