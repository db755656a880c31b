"""Windows of nodes around groups of bad cells, in the plane or in space."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, as_planar


@dataclass(frozen=True)
class Window:
    """The nodes with indices from `first` to `last`, inclusive; i may cross the seam of an O grid.

    >>> Window((-2, 0), (4, 3)).cells
    18
    """

    first: tuple[int, ...]
    last: tuple[int, ...]

    @property
    def cells(self) -> int:
        """Number of cells."""
        return int(np.prod(np.subtract(self.last, self.first)))

    def rows(self, ni: int, periodic: bool) -> NDArray[np.intp]:
        """Return the indices i (m,) of the window's nodes; in a `periodic` block, ni - 1 becomes 0."""
        rows = np.arange(self.first[0], self.last[0] + 1)
        return rows % (ni - 1) if periodic else rows

    def _index(self, rows: NDArray[np.intp], less: int) -> tuple[Any, ...]:
        """Return the index of the nodes in some rows, without `less` at both ends of other directions."""
        ends = zip(self.first[1:], self.last[1:], strict=True)
        return rows, *(slice(low + less, high + 1 - less) for low, high in ends)

    def cut(self, nodes: Floats, periodic: bool = False) -> Floats:
        """Return a copy of the nodes in this window, from `nodes` (ni, nj, 2) or (ni, nj, nk, 3)."""
        return as_planar(nodes[self._index(self.rows(len(nodes), periodic), 0)])

    def put(self, nodes: Floats, periodic: bool, patch: Floats) -> None:
        """Replace the window's inner nodes in `nodes` by the inner nodes of `patch` (see `cut`)."""
        inner = (slice(1, -1),) * len(self.first)
        nodes[self._index(self.rows(len(nodes), periodic)[1:-1], 1)] = patch[inner]
        if periodic:
            nodes[-1] = nodes[0]


def windows(
    bad: NDArray[np.int64], margin: int, shape: tuple[int, ...], periodic: bool, largest: int
) -> Iterator[Window]:
    """Yield windows (ranges of nodes) around groups of the cells with indices `bad` (n, d).

    The block, with node counts `shape` (d,), is divided into tiles of `margin` cells in each direction. Cells
    in the same tile, or in tiles that touch, form a group. A window contains the tiles of a group and those
    around them. If it would have more than `largest` cells, the group is divided, but never within a tile.
    If `periodic`, a window may extend across the seam, but not overlap itself.

    >>> list(windows(np.array([[20, 0], [22, 1]]), 6, (100, 50), False, 2500))
    [Window(first=(12, 0), last=(30, 12))]
    """
    around = -(-(shape[0] - 1) // margin)
    steps = [step for step in product((-1, 0, 1), repeat=len(shape)) if any(step)]
    waiting = {tuple(tile) for tile in np.unique(bad // margin, axis=0).tolist()}
    while waiting:
        group = [waiting.pop()]
        for tile in group:
            for step in steps:
                beside = tuple(a + b for a, b in zip(tile, step, strict=True))
                near = (beside[0] % around, *beside[1:]) if periodic else beside
                if near in waiting:
                    waiting.remove(near)
                    group.append(beside)
        yield from _cover(np.array(sorted(group)), margin, shape, periodic, largest)


def _cover(
    tiles: NDArray[np.int64], margin: int, shape: tuple[int, ...], periodic: bool, largest: int
) -> Iterator[Window]:
    """Yield windows that cover `tiles` (n, d) of `margin` cells; a large group is halved repeatedly."""
    low, high = tiles.min(axis=0), tiles.max(axis=0)
    first, last = (low - 1) * margin, (high + 2) * margin
    inside = slice(1, None) if periodic else slice(None)
    if periodic:
        last[0] = min(last[0], first[0] + shape[0] - 2)
    first[inside], last[inside] = np.maximum(first, 0)[inside], np.minimum(last, np.array(shape) - 1)[inside]
    window = Window(tuple(first.tolist()), tuple(last.tolist()))
    if window.cells <= largest or len(tiles) == 1:
        yield window
        return
    along = int(np.argmax(high - low))
    for half in np.array_split(tiles[np.argsort(tiles[:, along], kind="stable")], 2):
        yield from _cover(half, margin, shape, periodic, largest)
