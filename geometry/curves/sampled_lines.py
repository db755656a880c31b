"""Points at given arc lengths of lines of nodes."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import sampled_lines


def sampled(lines: Floats, arc: Floats, at: Floats) -> Floats:
    """Return points (k, n, ...) at arc lengths `at` (k, n), clipped, of cubic `lines` (k, m, ...).

    Tangents at nodes are those of parabolas through three nodes; `arc` (k, m) are the nodes' arc lengths.
    """
    points = np.empty((*at.shape, lines.shape[2]))
    lines, arc, at = (np.ascontiguousarray(each) for each in (lines, arc, np.minimum(at, arc[:, -1:])))
    sampled_lines(lines, arc, at, points)
    return points
