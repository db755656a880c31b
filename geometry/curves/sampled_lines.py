"""Points at given arc lengths of lines of nodes."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import sampled_lines


def sampled(lines: Floats, arc: Floats, at: Floats) -> Floats:
    """Return points (k, n, ...) at the arc lengths `at` (k, n) on piecewise cubic `lines` (k, m, ...).

    The tangents of the cubics at nodes are those of parabolas through three nodes. `arc` (k, m) are the arc
    lengths of the nodes. An arc length that exceeds the length of the line gives its last node.
    """
    points = np.empty((*at.shape, lines.shape[2]))
    lines, arc, at = (np.ascontiguousarray(each) for each in (lines, arc, np.minimum(at, arc[:, -1:])))
    sampled_lines(lines, arc, at, points)
    return points
