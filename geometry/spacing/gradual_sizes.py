"""Cell sizes along a closed curve that change gradually."""

import numpy as np

from meshonet.geometry.arrays import Floats


def graded(sizes: Floats, arcs: Floats, length: float, slope: float) -> Floats:
    """Return the largest sizes (n,), at most `sizes` (n,), that change by at most `slope` per arc length.

    They are at ascending `arcs` (n,) along a closed curve of this `length`.

    >>> graded(np.array([1.0, 9.0, 9.0, 9.0]), np.array([0.0, 1.0, 2.0, 3.0]), 4.0, 1.0).tolist()
    [1.0, 2.0, 3.0, 2.0]
    """
    n = len(sizes)
    along = np.concatenate([arcs - length, arcs, arcs + length])
    size = np.tile(sizes, 3)
    ahead = np.minimum.accumulate(size - slope * along) + slope * along
    behind = np.minimum.accumulate((size + slope * along)[::-1])[::-1] - slope * along
    return np.asarray(np.minimum(ahead, behind)[n : 2 * n])
