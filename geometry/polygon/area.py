"""Signed area of a polygon, points inside it, and the range of extents whose area can be computed."""

import numpy as np

from meshonet.geometry.arrays import Bools, Floats
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError


def polygon_area(points: Floats) -> float:
    """Return the signed area of a closed polygon (n, 2), positive when counter-clockwise.

    >>> import numpy as np
    >>> polygon_area(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]))
    2.0
    """
    x, y = (points - points[0]).T  # with the first point at 0 the closing edge contributes nothing
    return float(0.5 * (product(x[:-1], y[1:]) - product(x[1:], y[:-1])))


def check_extent(extent: float) -> None:
    """Raise InputError if the extent of a shape is 0, or too large or small to compute its area."""
    if not 1e-60 < extent < 1e60:
        what = "no extent" if extent == 0 else f"an extent of {extent:.3g}"
        raise InputError(f"the points have {what}", "give coordinates in a unit that suits the shape")


def contains(polygon: Floats, points: Floats) -> Bools:
    """Return whether `points` (..., 2) lie inside a polygon (n, 2)."""
    x, y = polygon[:, 0] - points[..., 0, None], polygon[:, 1] - points[..., 1, None]
    u, v = np.roll(x, -1, axis=-1), np.roll(y, -1, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        right = x - y * (u - x) / (v - y) > 0
    return np.asarray((((y > 0) != (v > 0)) & right).sum(axis=-1) % 2 == 1)
