"""Displacements of inner nodes that are harmonic on the graph of a mesh."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Bools, Floats
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.sparse import SparsePattern


def harmonic(mesh: QuadMesh, moves: Floats, given: Bools) -> Floats:
    """Return displacements (n, 2): `moves` (n, 2) where `given` (n,), elsewhere means of neighbours.

    Neighbours weigh as the inverse square of their distance, so that small cells keep their form. Nodes with
    a partner move as that does.
    """
    partner = mesh.places.partner
    own = np.where(partner >= 0, partner, np.arange(len(partner)))
    given = given | given[own]
    moves = np.where(given[:, None], moves, 0.0)
    free = np.flatnonzero(~given & (partner < 0))
    number = np.full(len(given), -1)
    number[free] = np.arange(len(free))
    off = mesh.nodes[mesh.edges[:, 1]] - mesh.nodes[mesh.edges[:, 0]]
    weight = 1.0 / (off**2).sum(axis=1)
    a, b = own[mesh.edges].T
    inner = ~given[a] & ~given[b]
    diagonal = (np.bincount(a, weight, len(given)) + np.bincount(b, weight, len(given)))[free]
    rows = np.concatenate([np.arange(len(free)), number[a[inner]]])
    columns = np.concatenate([np.arange(len(free)), number[b[inner]]])
    factor = SparsePattern(len(free), rows, columns).factor(np.concatenate([diagonal, -weight[inner]]))
    right = np.zeros((len(given), 2))
    for one, other in ((a, b), (b, a)):
        side = ~given[one] & given[other]
        for axis in (0, 1):
            right[:, axis] += np.bincount(one[side], weight[side] * moves[other[side], axis], len(given))
    out = moves.copy()
    for axis in (0, 1):
        out[free, axis] = factor.solve(np.ascontiguousarray(right[free, axis]))
    return out[own]
