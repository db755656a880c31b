"""Growth ratios of neighbouring cells along grid lines, also across the seam of O and the wake of C grids.

Growth at a node is the ratio of the two edges of a line there, the larger over the smaller.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, norms, percentiles_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch

Singles = NDArray[np.float32]
ROWS = 128  # columns of nodes processed at a time, so that large grids need little memory
DIRECTIONS = ("xi", "eta", "zeta")
LARGE = 1e30  # growth that is reported at an edge of zero length


@dataclass(frozen=True)
class Extreme:
    """Greatest value of a quantity, its mean and, if computed, its 99th percentile.

    `at` is the node or cell of the greatest value: (i, j), or in a multi-block grid (block, i, j[, k]).
    `along` is the direction, one of `DIRECTIONS`, in which it was measured; None if it has no direction.
    """

    max: float
    mean: float
    at: tuple[int, ...]
    p99: float | None = None
    along: str | None = None


@dataclass(frozen=True)
class Growth:
    """Growth ratios along each direction; None for a direction whose grid lines have a single edge."""

    xi: Extreme | None
    eta: Extreme | None
    zeta: Extreme | None = None

    def families(self) -> dict[str, Extreme]:
        """Return the growths that are not None, by direction."""
        return {name: extreme for name, extreme in vars(self).items() if extreme}


class Tally:
    """Maximum and mean of values that are added in parts, and, with ``kept=True``, the 99th percentile."""

    def __init__(self, *, kept: bool = False) -> None:
        self._max, self._total, self._count = -np.inf, 0.0, 0
        self._at: tuple[int, ...] = (0, 0)
        self._along: str | None = None
        self._values: list[Floats | Singles] | None = [] if kept else None

    def add(self, place: tuple[int, ...], values: Floats, along: str | None = None) -> None:
        """Add values (m, n[, l]) of nodes or cells; `place` is the first node or cell, such as (i, j)."""
        if values.size == 0:
            return
        here = np.unravel_index(int(values.argmax()), values.shape)
        number = len(place) - values.ndim
        at = (*place[:number], *(first + int(k) for first, k in zip(place[number:], here, strict=True)))
        self.add_summed(float(values[here]), float(values.sum()), values.size, at, along, [values])

    def add_summed(
        self,
        high: float,
        total: float,
        count: int,
        at: tuple[int, ...],
        along: str | None,
        values: Sequence[Floats | Singles],
    ) -> None:
        """Add `values` whose `count`, sum `total` and maximum `high` (at node or cell `at`) are known."""
        if high > self._max:
            self._max, self._at, self._along = high, at, along
        self._total += total
        self._count += count
        if self._values is not None:
            self._values += [part.ravel() for part in values]

    def add_all(self, other: "Tally") -> None:
        """Add the values of another tally."""
        if other._count:
            values = other._values or ()
            self.add_summed(other._max, other._total, other._count, other._at, other._along, values)

    @property
    def extreme(self) -> Extreme | None:
        """Statistics of all values added so far; None without values."""
        if not self._count:
            return None
        p99 = None if self._values is None else percentiles_of(np.concatenate(self._values), (99,))[0]
        return Extreme(self._max, self._total / self._count, self._at, p99, self._along)


def growth(grid: Grid) -> Growth:
    """Return the growth ratios along xi and eta, in a grid of one planar block."""
    xi, eta = Tally(), Tally()
    for i, block in strips(beyond_seam(grid), 2):
        xi.add((i + 1, 0), ratios(block), "xi")
    for i, block in strips(grid.nodes, 0):
        eta.add((i, 1), ratios(block.swapaxes(0, 1)).T, "eta")
    eta.add((0, 0), ratios(across_wake(grid).swapaxes(0, 1)).T, "eta")
    return Growth(xi.extreme, eta.extreme)


def growth_off_walls(growth: Growth, walls: Sequence[Patch]) -> Extreme | None:
    """Return the growth along the grid lines that start at `walls`, for a grid of one block."""
    sides = {patch.side for patch in walls}
    families = (growth.eta, {"south", "north"}), (growth.xi, {"west", "east"})
    return most_of(extreme for extreme, ends in families if extreme and sides & ends)


def most_of(extremes: Iterable[Extreme | None]) -> Extreme | None:
    """Return the extreme with the greatest value; None if there is none."""
    return max((each for each in extremes if each), key=lambda extreme: extreme.max, default=None)


def beyond_seam(grid: Grid) -> Floats:
    """Return the nodes (ni, nj, 2) of a grid; of an O grid, (ni + 1, nj, 2) with one line past the seam."""
    return np.concatenate([grid.nodes, grid.nodes[1:2]]) if grid.periodic else grid.nodes


def across_wake(grid: Grid) -> Floats:
    """Return the nodes (n, 3, 2) below, on and above the wake of a C grid; none for other grids."""
    nodes = grid.wake + 1 if grid.wake else 0
    below = grid.nodes[::-1][:nodes, 1]
    return np.stack([below, grid.nodes[:nodes, 0], grid.nodes[:nodes, 1]], axis=1)


def strips(nodes: Floats, more: int) -> Iterator[tuple[int, Floats]]:
    """Yield parts of `nodes` (ni, nj, 2), with their first index i; neighbours share `more` lines."""
    for i in range(0, max(len(nodes) - more, 0), ROWS):
        yield i, nodes[i : i + ROWS + more]


def ratios(nodes: Floats) -> Floats:
    """Return ratios >= 1 (m-2, ...) of successive edges along the first axis of `nodes` (m, ..., d)."""
    length = norms(np.diff(nodes, axis=0))
    before, after = length[:-1], length[1:]
    small = np.minimum(before, after)
    ratio = np.divide(np.maximum(before, after), small, out=np.full_like(small, LARGE), where=small > 0)
    return np.minimum(ratio, LARGE)
