"""What a stage of the decomposition says when it cannot go on, and where."""

import numpy as np

from meshonet.geometry.arrays import complex_of
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.quad_mesh import QuadMesh


class BlockingError(SolverError):
    """A stage failed for one triangulation of a domain; another triangulation may do."""


def most_folded(mesh: QuadMesh) -> str:
    """Return where the corner is that is folded most, for a message.

    A corner whose Jacobian is not a number counts as the most folded one.
    """
    z = complex_of(mesh.nodes[mesh.quads])
    jacobian = (np.conj(np.roll(z, -1, axis=1) - z) * (np.roll(z, 1, axis=1) - z)).imag
    at = z.ravel()[int(np.argmin(np.nan_to_num(jacobian, nan=-np.inf)))]
    return f"at ({at.real:.6g}, {at.imag:.6g})"
