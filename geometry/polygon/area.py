"""The area of a polygon, and the sizes whose areas can be computed."""

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError


def polygon_area(points: Floats) -> float:
    """Return the signed area of a closed polygon (n, 2), positive when counter-clockwise.

    >>> import numpy as np
    >>> polygon_area(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]))
    2.0
    """
    x, y = (points - points[0]).T  # the first point, now 0, closes it with nothing
    return float(0.5 * (product(x[:-1], y[1:]) - product(x[1:], y[:-1])))


def check_extent(extent: float) -> None:
    """Raise InputError when the size of a shape is 0, or too large or small for its area to be computed."""
    if not 1e-60 < extent < 1e60:
        what = "no extent" if extent == 0 else f"an extent of {extent:.3g}"
        raise InputError(f"the points have {what}", "give coordinates in a unit that suits the shape")
