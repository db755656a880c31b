"""A layout: the blocks of a quad mesh, coarse or with the final number of cells.

A block is an array of node numbers: its indices give the orientation, and neighbours share numbers.

::

    block[i, j] = node        sides: south block[:, 0], north block[:, -1], west block[0], east block[-1]

A coarse layout defines the blocks and their approximate position; `meshonet.solvers.blocking` refines and
optimises it. A fine layout, with the final number of cells, is a grid whose blocks share nodes.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from meshonet.geometry.arrays import Bools, Indices, distinct
from meshonet.geometry.cached import cached_property
from meshonet.geometry.layout.quad_mesh import QuadMesh


@dataclass(frozen=True, eq=False)
class Layout:
    """Blocks that cover the quads of a mesh; each block is an array (ni, nj) of node indices.

    Parameters
    ----------
    mesh : QuadMesh
        Quadrilaterals, their nodes, and the positions of nodes on the boundary.
    blocks : tuple of array
        Right-handed arrays (ni, nj) of node indices; each quad of the mesh is in exactly one block.
    layers : dict, optional
        Number of rows of cells, counted from the south side, that are layers at a wall; the key is the index
        of the block. Optimisations do not move these rows.
    fronts : tuple of int, optional
        Indices of boundary loops that are outer edges of layers. The layers are added to the domain later.
    """

    mesh: QuadMesh
    blocks: tuple[Indices, ...]
    layers: Mapping[int, int] = field(default_factory=dict)
    fronts: tuple[int, ...] = ()

    @cached_property
    def vertices(self) -> Indices:
        """Indices (v,) of the nodes at corners of blocks, ascending."""
        corners = [block[[0, -1, -1, 0], [0, 0, -1, -1]] for block in self.blocks]
        return np.asarray(distinct(np.concatenate(corners)))

    def beside(self, on: Bools) -> list[Indices]:
        """Return, for each block side whose nodes are all in the mask `on` (n,), the block's nodes (k, m).

        Each array of node indices is turned so that its column 0 is the side.
        """
        tables = [t for block in self.blocks for t in (block, block[:, ::-1], block.T, block.T[:, ::-1])]
        return [table for table in tables if on[table[:, 0]].all()]

    @property
    def cells(self) -> int:
        """Number of cells in all blocks."""
        return int(sum((len(block) - 1) * (block.shape[1] - 1) for block in self.blocks))
