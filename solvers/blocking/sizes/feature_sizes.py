"""Cell sizes that resolve the curvature, the corners and the gaps of the walls of a domain."""

import numpy as np

from meshonet.geometry.arrays import turned_left
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.gap import wall_gaps
from meshonet.geometry.domain.wall_turning import sizes_by_bend
from meshonet.geometry.spacing.gradual_sizes import graded
from meshonet.solvers.refinement.size_metric import SizeMetric

TURN = np.radians(20.0)
"""Largest angle by which a wall turns along one cell."""
CELLS_IN_GAP = 2.5  # so that at least two quads cross every gap
CELLS_AROUND = 24.0
"""Smallest number of cells around a loop."""
ALONG_WALL = 0.2
"""Growth of sizes along walls per length."""
INSIDE = 0.2
"""Growth of sizes with the distance from walls."""
CELLS_ACROSS = 30.0
"""Smallest number of cells across a domain, far from all features."""


def feature_sizes(domain: Domain) -> SizeMetric:
    """Return isotropic cell sizes that resolve all features of the walls of a domain."""
    points, normals, sizes = [], [], []
    for loop in domain.loops:
        arcs, size = sizes_by_bend(loop, loop.length / CELLS_AROUND, TURN)
        size = np.minimum(size, wall_gaps(domain, loop, arcs) / CELLS_IN_GAP)
        points.append(loop.at(arcs))
        normals.append(turned_left(loop.tangent(arcs)))
        sizes.append(graded(size, arcs, loop.length, ALONG_WALL))
    size = np.concatenate(sizes)
    largest = domain.extent / CELLS_ACROSS
    return SizeMetric(np.concatenate(points), np.concatenate(normals), size, size, largest, INSIDE)
