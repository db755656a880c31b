"""Error of a stage of the decomposition, with its place."""

import numpy as np

from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.lattice import corner_jacobians
from meshonet.geometry.layout.quad_mesh import QuadMesh


class BlockingError(SolverError):
    """A stage failed for one triangulation of a domain; another triangulation may succeed."""


def most_folded(mesh: QuadMesh) -> str:
    """Return the place of the most folded corner for a message.

    A corner whose Jacobian is not a number counts as the most folded one.
    """
    jacobian = np.nan_to_num(corner_jacobians(mesh.nodes[mesh.quads]), nan=-np.inf)
    x, y = mesh.nodes[mesh.quads.ravel()[int(np.argmin(jacobian))]]
    return f"at ({x:.6g}, {y:.6g})"
