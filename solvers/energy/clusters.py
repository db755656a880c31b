"""Windows of nodes around groups of bad cells."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, as_planar

NEIGHBOURS = [(da, db) for da in (-1, 0, 1) for db in (-1, 0, 1) if (da, db) != (0, 0)]


@dataclass(frozen=True)
class Window:
    """Nodes i0 .. i1 and j0 .. j1, inclusive; i may extend across the seam of an O grid.

    >>> Window(-2, 4, 0, 3).cells
    18
    """

    i0: int
    i1: int
    j0: int
    j1: int

    @property
    def cells(self) -> int:
        """Number of cells."""
        return (self.i1 - self.i0) * (self.j1 - self.j0)

    def rows(self, ni: int, periodic: bool) -> NDArray[np.intp]:
        """Return the first indices of the nodes in a grid with `ni` rows."""
        rows = np.arange(self.i0, self.i1 + 1)
        return rows % (ni - 1) if periodic else rows

    def cut(self, nodes: Floats, periodic: bool) -> Floats:
        """Return a planar copy of the window's part of `nodes` (ni, nj, 2)."""
        return as_planar(nodes[self.rows(len(nodes), periodic), self.j0 : self.j1 + 1])

    def put(self, nodes: Floats, periodic: bool, patch: Floats) -> None:
        """Set the inner nodes of the window to those of `patch`, which has the shape returned by `cut`."""
        nodes[self.rows(len(nodes), periodic)[1:-1], self.j0 + 1 : self.j1] = patch[1:-1, 1:-1]
        if periodic:
            nodes[-1] = nodes[0]


def windows(
    bad: NDArray[np.int64], margin: int, shape: tuple[int, ...], periodic: bool, largest: int
) -> Iterator[Window]:
    """Yield windows around the groups of cells `bad` (n, 2), with at least `margin` cells around each.

    Bad cells form a group if their tiles of `margin` cells touch. A group that needs more than `largest`
    cells is divided, if necessary down to single tiles. Windows stay inside the (ni, nj) nodes of `shape`; if
    `periodic`, a window may extend across the seam, but not overlap itself.

    >>> list(windows(np.array([[20, 0], [22, 1]]), 6, (100, 50), False, 2500))
    [Window(i0=12, i1=30, j0=0, j1=12)]
    """
    around = -(-(shape[0] - 1) // margin)
    waiting = {(int(a), int(b)) for a, b in np.unique(bad // margin, axis=0)}
    while waiting:
        group = [waiting.pop()]
        for a, b in group:
            for da, db in NEIGHBOURS:
                near = ((a + da) % around if periodic else a + da, b + db)
                if near in waiting:
                    waiting.remove(near)
                    group.append((a + da, b + db))
        yield from _cover(np.array(sorted(group)), margin, shape, periodic, largest)


def _cover(
    tiles: NDArray[np.int64], margin: int, shape: tuple[int, ...], periodic: bool, largest: int
) -> Iterator[Window]:
    """Yield windows that cover `tiles` (n, 2) of `margin` cells; a large group is halved repeatedly."""
    low, high = tiles.min(axis=0), tiles.max(axis=0)
    i0, j0 = (int(k) for k in (low - 1) * margin)
    i1, j1 = (int(k) for k in (high + 2) * margin)
    i0, i1 = (i0, min(i1, i0 + shape[0] - 2)) if periodic else (max(i0, 0), min(i1, shape[0] - 1))
    window = Window(i0, i1, max(j0, 0), min(j1, shape[1] - 1))
    if window.cells <= largest or len(tiles) == 1:
        yield window
        return
    along = int(np.argmax(high - low))
    for half in np.array_split(tiles[np.argsort(tiles[:, along], kind="stable")], 2):
        yield from _cover(half, margin, shape, periodic, largest)
