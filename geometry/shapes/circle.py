"""A circle by its radius: the section of a pipe, or a cylinder across a flow."""

import math

import numpy as np

from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.outline import Outline

POINTS = 256  # points of the curve, which is within 1e-9 of the radius everywhere


class Circle(Outline):
    """A circle around the origin. Raises InputError: a radius that is not positive."""

    def __init__(self, radius: float) -> None:
        if not 1e-9 <= radius <= 1e9:
            raise InputError(f"a circle of radius {radius:g}", "use 1e-9 to 1e9")
        angle = np.linspace(0.0, 2.0 * math.pi, POINTS, endpoint=False)
        super().__init__(radius * np.stack([cos(angle), sin(angle)], axis=1), f"circle {radius:g}")
        self.radius = radius


def circle(designation: str) -> Circle:
    """Return the circle whose radius is given as text, such as ``0.5``. Raises InputError: not positive.

    >>> circle("0.5").radius
    0.5
    """
    try:
        radius = float(designation)
    except ValueError:
        raise InputError(f"{designation!r} is no radius", "use e.g. circle:0.5") from None
    return Circle(radius)
