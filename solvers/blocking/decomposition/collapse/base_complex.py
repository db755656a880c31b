"""The blocks of a quad mesh, bounded by its grid lines through irregular nodes.

From every irregular node all edges are followed straight through regular nodes, to the boundary or another
irregular node. The regions between these lines are lattices or rings; a ring is divided by one more line.

Tarini, Puppo, Panozzo, Pietroni, Cignoni, "Simple quad domains for field aligned mesh parametrization", ACM
Trans. Graph. 30 (2011), section 3.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.kernels._native import split_quads


@dataclass(frozen=True, eq=False)
class BaseComplex:
    """Blocks of a quad mesh, the edges that bound them, and the chords: sets of opposite sides of blocks.

    A chord has all block sides that are reached from one side by repeatedly crossing a block to the opposite
    side. All sides of a chord have the same number of cells.
    """

    mesh: QuadMesh
    blocks: tuple[Indices, ...]  # lattices (ni, nj) of nodes, right-handed
    bounds: Bools  # (e,) mask of the edges that bound blocks
    chord: Indices  # (e,) chord of each edge: one for opposite sides of a block and all edges between them
    chords: int

    @property
    def layout(self) -> Layout:
        """The blocks as a `Layout` object."""
        return Layout(self.mesh, self.blocks)

    @cached_property
    def sides(self) -> tuple[Indices, Indices, Indices]:
        """Edges along the south, north, west and east sides of b blocks, as three arrays.

        The first (k,) lists the edges of all sides, one side after another, with -1 at the end of each side.
        The second (4 b,) has the place in this list at which each side begins. The third (4 b,) has the
        index of each side's chord, a set of sides that are opposite each other in one block after another.
        """
        lines = [line for block in self.blocks for line in (block[:, 0], block[:, -1], block[0], block[-1])]
        nodes = np.concatenate(lines)
        first = np.cumsum([0] + [len(line) for line in lines[:-1]])
        edge = np.append(self.mesh.edges_between(nodes[:-1], nodes[1:]), -1)
        edge[first[1:] - 1] = -1
        return edge, first, self.chord[edge[first]]

    def moved(self, mesh: QuadMesh) -> Self:
        """Return the same blocks with the nodes of `mesh`, which has the same quads."""
        moved = replace(self, mesh=mesh)
        if "sides" in self.__dict__:
            moved.__dict__["sides"] = self.sides
        return moved

    def side_lengths(self, unit: Floats | None = None) -> Floats:
        """Return the lengths (b, 4) of the south, north, west and east side of each block.

        `unit` (e,), if given, has a divisor for the length of each edge of the mesh.
        """
        edge, first, _ = self.sides
        length = self.mesh.edge_lengths
        if unit is not None:
            length = length / unit
        along = np.where(edge >= 0, length[edge], 0.0)
        return np.asarray(np.add.reduceat(along, first).reshape(-1, 4))


def base_complex(mesh: QuadMesh, lines: Bools | None = None) -> BaseComplex:
    """Return the blocks of a quad mesh; edges in the mask `lines` (e,) are block boundaries too.

    Raises SolverError if the mesh is not manifold, or if a block does not consist of rows and columns.
    """
    quads = np.ascontiguousarray(mesh.quads, dtype=np.intp)
    bounds = mesh.on_wall.copy() if lines is None else mesh.on_wall | lines
    parts = None
    if mesh.manifold:
        parts = split_quads(quads, mesh.edge_of, mesh.twin, mesh.irregular, bounds)
    if parts is None:
        raise SolverError("the lines of the quad mesh do not bound lattices")
    blocks, chord, chords = parts
    return BaseComplex(mesh, tuple(blocks), bounds, chord, chords)
