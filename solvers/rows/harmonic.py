"""Displacements of inner nodes that are harmonic on the graph of a mesh."""

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, dots
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.sparse import SparsePattern


class HarmonicMoves:
    """Displacements of nodes that are harmonic except where prescribed.

    A free node moves by the mean displacement of its neighbours, weighted by inverse square distances. Both
    nodes of a periodic pair move alike.

    Parameters
    ----------
    mesh : any mesh with the same connectivity as those for which moves are computed later.
    prescribed : (n,) mask of the nodes with prescribed displacements.
    """

    def __init__(self, mesh: QuadMesh, prescribed: Bools) -> None:
        partner = mesh.places.partner
        self.own = np.where(partner >= 0, partner, np.arange(len(partner)))
        self.prescribed = prescribed | prescribed[self.own]
        self.free = np.flatnonzero(~self.prescribed & (partner < 0))
        number = np.full(len(prescribed), -1)
        number[self.free] = np.arange(len(self.free))
        self.edges = self.own[mesh.edges].T
        a, b = self.edges
        self.inner = ~self.prescribed[a] & ~self.prescribed[b]
        diagonal = np.arange(len(self.free))
        rows, columns = (np.concatenate([diagonal, number[ends[self.inner]]]) for ends in (a, b))
        self.pattern = SparsePattern(len(self.free), rows, columns)

    def of(self, mesh: QuadMesh, moves: Floats) -> Floats:
        """Return displacements (n, 2): `moves` (n, 2) at prescribed nodes, harmonic elsewhere."""
        moves = np.where(self.prescribed[:, None], moves, 0.0)
        (a, b), count = self.edges, len(moves)
        off = mesh.nodes[mesh.edges[:, 1]] - mesh.nodes[mesh.edges[:, 0]]
        weight = 1.0 / dots(off, off)
        diagonal = (np.bincount(a, weight, count) + np.bincount(b, weight, count))[self.free]
        factor = self.pattern.factor(np.concatenate([diagonal, -weight[self.inner]]))
        right = np.zeros((count, 2))
        for one, other in ((a, b), (b, a)):
            side = ~self.prescribed[one] & self.prescribed[other]
            for axis in (0, 1):
                right[:, axis] += np.bincount(one[side], weight[side] * moves[other[side], axis], count)
        moves[self.free] = factor.solve(right[self.free])
        return moves[self.own]
