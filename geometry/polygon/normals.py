"""Normals at the points of a closed polygon."""

from meshonet.geometry.arrays import Floats, norms, rolled, turned_left


def left_normals(ring: Floats) -> Floats:
    """Return unit normals (n, 2) at the points (n, 2) of a closed polygon, to the left of its direction.

    Each bisects the angle between the two sides at its point.

    >>> import numpy as np
    >>> left_normals(np.array([[0.0, 0], [0, 1], [1, 1], [1, 0]])).round(3).tolist()
    [[-0.707, -0.707], [-0.707, 0.707], [0.707, 0.707], [0.707, -0.707]]
    """
    step = rolled(ring, -1) - ring
    along = step / norms(step)[:, None]
    normals = turned_left(along + rolled(along, 1))
    return normals / norms(normals)[:, None]
