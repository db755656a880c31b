"""Edges of nodes for the families."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Floats
from geometry.stretch import on_corners


def polyline(corners: list[tuple[float, float]], n: int) -> Floats:
    """Return n nodes (n, 2) along straight pieces, in nearly equal steps, every corner bitwise a node.

    Examples
    --------
    >>> polyline([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], 5).tolist()
    [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 0.5], [1.0, 1.0]]
    """
    points = np.array(corners, dtype=np.float64)
    knots = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    s = on_corners(np.linspace(0.0, knots[-1], n), knots[1:-1])
    nodes = np.stack([np.interp(s, knots, points[:, 0]), np.interp(s, knots, points[:, 1])], axis=1)
    nodes[np.searchsorted(s, knots)] = points
    return nodes
