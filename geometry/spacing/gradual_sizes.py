"""Cell sizes along a curve that change gradually."""

import numpy as np

from meshonet.geometry.arrays import Floats


def limited_sizes(sizes: Floats, arcs: Floats, slope: float) -> Floats:
    """Return the largest sizes (..., n) below `sizes` whose change per arc length is at most `slope`.

    `sizes` (..., n) are given at ascending arc lengths `arcs` (n,) along an open curve.
    """
    rise = slope * arcs
    ahead = np.minimum.accumulate(sizes - rise, axis=-1) + rise
    return np.asarray(np.minimum.accumulate((ahead + rise)[..., ::-1], axis=-1)[..., ::-1] - rise)


def graded(sizes: Floats, arcs: Floats, length: float, slope: float) -> Floats:
    """Return the largest sizes (n,) below `sizes` (n,) whose change per arc length is at most `slope`.

    Sizes are given at ascending arc lengths `arcs` (n,) along a closed curve of this `length`.

    >>> graded(np.array([1.0, 9.0, 9.0, 9.0]), np.array([0.0, 1.0, 2.0, 3.0]), 4.0, 1.0).tolist()
    [1.0, 2.0, 3.0, 2.0]
    """
    along = np.concatenate([arcs - length, arcs, arcs + length])
    size, rise = np.tile(sizes, 3), slope * along
    ahead = np.minimum.accumulate(size - rise) + rise
    behind = np.minimum.accumulate((size + rise)[::-1])[::-1] - rise
    return np.asarray(np.minimum(ahead, behind)[len(sizes) : 2 * len(sizes)])
