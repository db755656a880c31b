r"""The valence of each node of a multi-block grid, and its irregular vertices.

::

    +--+--+     inner nodes where four cells meet, and boundary nodes where two meet, are regular;
    |  |  |     an irregular inner node, of three or five cells for instance, is a corner of blocks
    +--o--+
    |   \  \
    +----+--+
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, ring_of
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import shared_nodes


@dataclass(frozen=True, eq=False)
class Vertices:
    """The distinct nodes of a grid of planar blocks; the two nodes of a periodic pair count as one.

    Parameters
    ----------
    numbers : for each block, (ni, nj) the indices of its nodes among the n distinct nodes.
    valence : (n,) number of cells that meet at each node.
    outer : (n,) whether the node is on the boundary.
    """

    numbers: tuple[Indices, ...]
    valence: Indices
    outer: Bools

    @cached_property
    def regular(self) -> Bools:
        """Whether each node (n,) is regular: four cells meet there, or two if it is on the boundary."""
        return np.asarray(self.valence == np.where(self.outer, 2, 4))

    @cached_property
    def irregular(self) -> Indices:
        """Indices of the inner nodes at which fewer or more than four cells meet."""
        return np.flatnonzero((self.valence != 4) & ~self.outer)

    def place(self, node: int) -> tuple[int, int, int]:
        """Return block, i and j of the first occurrence of a node."""
        for block, numbers in enumerate(self.numbers):
            places = np.argwhere(numbers == node)
            if len(places):
                return block, int(places[0, 0]), int(places[0, 1])
        raise ValueError(f"no node {node}")


def vertices(grid: Grid) -> Vertices:
    """Return the nodes, with their valence, of a grid of planar blocks."""
    numbers = shared_nodes([block.counts for block in grid.blocks], grid.connections, periodic=True)
    count = 1 + max(int(number.max()) for number in numbers)
    corners = [ring_of(number).ravel() for number in numbers]
    valence = np.bincount(np.concatenate(corners), minlength=count)
    outer = np.zeros(count, dtype=bool)
    for patch in grid.outer_patches():
        outer[face_of(numbers[patch.block], patch.side)[patch.start : patch.stop + 1]] = True
    return Vertices(numbers, valence, outer)


def irregular_points(grid: Grid) -> tuple[Floats, Indices]:
    """Return the inner nodes (n, 2) at which more or fewer than four cells meet, and how many (n,) meet."""
    nodes = vertices(grid)
    places = [nodes.place(int(node)) for node in nodes.irregular]
    points = [grid.blocks[block].nodes[i, j] for block, i, j in places]
    return np.array(points).reshape(-1, 2), nodes.valence[nodes.irregular]
