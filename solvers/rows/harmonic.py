"""Displacements of inner nodes that are harmonic on the graph of a mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.sparse import SparsePattern


def harmonic(mesh: QuadMesh, moves: Floats, given: NDArray[np.bool_]) -> Floats:
    """Return displacements (n, 2): `moves` (n, 2) where `given` (n,), elsewhere means of neighbours."""
    free = np.flatnonzero(~given)
    number = np.full(len(given), -1)
    number[free] = np.arange(len(free))
    a, b = mesh.edges.T
    inner = ~given[a] & ~given[b]
    diagonal = np.bincount(mesh.edges.ravel(), minlength=len(given))[free].astype(np.float64)
    rows = np.concatenate([np.arange(len(free)), number[a[inner]]])
    columns = np.concatenate([np.arange(len(free)), number[b[inner]]])
    values = np.concatenate([diagonal, np.full(int(inner.sum()), -1.0)])
    factor = SparsePattern(len(free), rows, columns).factor(values)
    right = np.zeros((len(given), 2))
    for one, other in ((a, b), (b, a)):
        side = ~given[one] & given[other]
        for axis in (0, 1):
            right[:, axis] += np.bincount(one[side], moves[other[side], axis], len(given))
    out = moves.copy()
    for axis in (0, 1):
        out[free, axis] = factor.solve(np.ascontiguousarray(right[free, axis]))
    return out
