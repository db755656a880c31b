"""O grids of the compiled conformal solver whose Picard steps are repeated until nothing moves."""

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.conformal.solve import solve
from meshonet.solvers.conformal.strip import across, harmonic, picard

STILL = 1e-13
"""Change (radians) in a step at which the iteration ends."""
MOST = 100_000


def converged(boundary: Boundary) -> Floats:
    """Return the nodes (ni, nj, 2)."""
    return solve([boundary], "off", _correction)[0].grid.nodes


def _correction(walls: Complexes, fars: Complexes, _: object) -> Complexes:
    """Return the limit of the compiled steps minus the harmonic extension.

    The filter applies once to the whole change, in place of once to each step.
    """
    back = 1.0 - across().smooth[:, None]
    results = []
    for wall, far in zip(walls, fars, strict=True):
        start = c = harmonic(wall, far, across().eta)
        for _ in range(MOST):
            before, c = c, picard(c, 1)[0] + back * (start - c)
            if np.abs(c - before).max() < STILL:
                break
        results.append(c - start)
    return np.array(results)
