"""The Laplacian on a triangulated surface with linear elements, and given values at some vertices."""

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats
from meshonet.solvers.blocking.decomposition.surface.surface import NEXT, PREVIOUS, Triangulation
from meshonet.solvers.sparse import Factor, SparsePattern


class Laplacian:
    """Laplacian matrix of a surface, with unknowns at the vertices in the mask `free` (n,)."""

    def __init__(self, surface: Triangulation, free: Bools) -> None:
        self.surface, self.free = surface, free
        number = np.cumsum(free) - 1
        start, stop, weight = surface.triangles, surface.triangles[:, NEXT], surface.edge_weights
        both = free[start] & free[stop]
        each = np.arange(int(free.sum()))
        self.pattern = SparsePattern(
            len(each), np.concatenate([number[start[both]], each]), np.concatenate([number[stop[both]], each])
        )
        self._edges = weight[both]
        self._diagonal = surface.gather(-weight - weight[:, PREVIOUS])[free]

    def factor(self, mass: Floats | float = 0.0) -> Factor:
        """Return the factored matrix, after `mass` (free,) is added to its diagonal."""
        return self.pattern.factor(np.append(self._edges, self._diagonal + mass))

    def flow(self, values: Complexes) -> Complexes:
        """Return the right-hand side of the discrete equation from known `values` (n,), 0 at unknowns."""
        surface, weight = self.surface, self.surface.edge_weights
        corner = values[surface.triangles]
        flow = -weight * corner[:, NEXT] - weight[:, PREVIOUS] * corner[:, PREVIOUS]
        return np.asarray((surface.gather(flow.real) + 1j * surface.gather(flow.imag))[self.free])


def solve_complex(factor: Factor, right: Complexes) -> Complexes:
    """Return the complex solution (n,) of a real factored system with the complex right-hand side `right`."""
    pairs = np.ascontiguousarray(right).view(np.float64).reshape(-1, 2)
    return np.asarray(factor.solve(pairs).view(np.complex128)[:, 0])
