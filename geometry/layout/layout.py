"""A layout: the blocks of a quad mesh, and how many cells they want.

A block is a lattice of node numbers, so that orientation is in the array and neighbours share numbers:

::

    block[i, j] = node        sides: south block[:, 0], north block[:, -1], west block[0], east block[-1]

A coarse layout says which blocks there are and roughly where; `meshonet.solvers.blocking` refines and
optimises it. A fine one, as many cells as wanted, is a grid that shares its nodes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import distinct
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices


@dataclass(frozen=True, eq=False)
class Layout:
    """Blocks (ni, nj) of node numbers that cover the quads of a mesh.

    Parameters
    ----------
    mesh : QuadMesh
        Nodes and their places on the boundary.
    blocks : tuple of array
        Lattices of node numbers, right-handed; each quad of the mesh is in one of them.
    layers : dict, optional
        By number of a block, how many rows of cells from its south side are layers at a wall whose heights
        are given, so that no optimisation moves them.
    fronts : tuple of int, optional
        Numbers of the loops that are no walls but the fronts of layers around them, which come later.
    """

    mesh: QuadMesh
    blocks: tuple[Indices, ...]
    layers: Mapping[int, int] = field(default_factory=dict)
    fronts: tuple[int, ...] = ()

    @cached_property
    def vertices(self) -> Indices:
        """(v,) nodes that are corners of blocks, ascending."""
        corners = [block[[0, -1, -1, 0], [0, 0, -1, -1]] for block in self.blocks]
        return np.asarray(distinct(np.concatenate(corners)))

    @property
    def cells(self) -> int:
        """Cells of all blocks."""
        return int(sum((len(block) - 1) * (block.shape[1] - 1) for block in self.blocks))
