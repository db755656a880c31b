"""Edges of nodes for the families."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.spacing.along_curve import on_corners

Corners = list[tuple[float, float]]


def polyline(corners: Corners, n: int, like: Corners | None = None) -> Floats:
    """Return n nodes (n, 2) along straight pieces, in nearly equal steps, every corner bitwise a node.

    With `like`, as many corners, each lies on the node where that polyline has it.

    Examples
    --------
    >>> polyline([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], 5).tolist()
    [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 0.5], [1.0, 1.0]]
    """
    points = np.array(corners, dtype=np.float64)
    pieces = np.diff(points if like is None else np.array(like), axis=0)
    knots = np.concatenate([[0.0], np.cumsum(np.hypot(*pieces.T))])
    s = on_corners(np.linspace(0.0, knots[-1], n), knots[1:-1])
    nodes = np.stack([np.interp(s, knots, points[:, 0]), np.interp(s, knots, points[:, 1])], axis=1)
    nodes[np.searchsorted(s, knots)] = points
    return nodes
