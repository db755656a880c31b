"""A folded cell, as errors and reports name it."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid


@dataclass(frozen=True)
class BadCell:
    """A folded cell: its block, its indices i, j, k, and its centre x, y, z.

    `block` is None in a grid of one block, `k` is None except in volumes, and `z` is None in the plane.
    """

    i: int
    j: int
    x: float
    y: float
    block: int | None = None
    k: int | None = None
    z: float | None = None

    @property
    def indices(self) -> str:
        """Text such as ``block=2, i=3, j=4, k=5``, without the values that are None."""
        places = {"block": self.block, "i": self.i, "j": self.j, "k": self.k}
        return ", ".join(f"{name}={value}" for name, value in places.items() if value is not None)

    @property
    def centre(self) -> str:
        """Text such as ``x=0.1, y=0.2, z=0.3``, without the values that are None."""
        places = {"x": self.x, "y": self.y, "z": self.z}
        return ", ".join(f"{name}={value:.6g}" for name, value in places.items() if value is not None)

    def __str__(self) -> str:
        return f"{self.indices}, {self.centre}"


def centre_of(grid: Grid, at: tuple[int, ...]) -> Floats:
    """Return the centre (2,) or (3,) of the cell `at`, which is (i, j), (block, i, j) or (block, i, j, k).

    The index of the last node along a direction stands for the last cell.
    """
    block, *place = at if len(at) > 2 else (0, *at)
    nodes = grid.blocks[block].nodes
    counts = nodes.shape[:-1]
    corners = tuple(slice(m := min(k, n - 2), m + 2) for k, n in zip(place, counts, strict=True))
    return np.asarray(nodes[corners].mean(axis=tuple(range(len(counts)))))
