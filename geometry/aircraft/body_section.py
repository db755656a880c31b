"""Cross-sections of a body that is not a body of revolution."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, arc_lengths, norms
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.elementary import arctan2, cos, power, sin
from meshonet.geometry.errors import InputError, in_place
from meshonet.geometry.polygon.corners import turning

ANGLES = 513  # number of angles from keel to crown at which the shape of a section is stored
_DENSE = 8  # number of points on the spline between two given points, from which the shape is interpolated
_FEWEST_POINTS = 5
_EXPONENTS = 1.2, 20.0  # smallest and largest exponent: from about a rhombus to about a rectangle
_MOST_TURN = math.radians(60.0)  # largest turn of a section at a point; beside it the spline would bulge
_IN_PLANE = 1e-6  # rounding of coordinates: largest distance of an end from z = 0, in widths


@dataclass(frozen=True, eq=False)
class BodySection:
    """A cross-section of a body in a plane of constant x, symmetric about z = 0.

    If width, height and points are left out, it is a single point: the nose or the tail.

    Parameters
    ----------
    x : float
        Position of the plane.
    y : float, optional
        For a superellipse, the y of its centre. For `points`, their displacement along y.
    width, height : float, optional
        Size of a superellipse.
    exponent : float, optional
        Exponent of the superellipse: 2 gives an ellipse, more a rectangle with rounded corners.
    points : array, optional
        Half the section in place of a superellipse: y and z (n, 2) from bottom to top or reverse, z >= 0.

    Raises
    ------
    InputError
        A width without a height, or the reverse; a value out of range; points that do not begin and end at z
        = 0, that have a sharp corner, or whose curve crosses a ray from the middle twice.

    Examples
    --------
    >>> from meshonet import BodySection
    >>> BodySection(3.0, width=1.4, height=1.2).halves
    (0.7, 0.6)
    """

    x: float
    y: float = 0.0
    width: float = 0.0
    height: float = 0.0
    exponent: float = 2.0
    points: Floats | None = None

    def __post_init__(self) -> None:
        if self.points is not None:
            with in_place("points"):
                points = _half_section(np.asarray(self.points, dtype=np.float64))
            object.__setattr__(self, "points", points)
            self._seen  # noqa: B018 - a ray that meets it twice is refused at once
        for name in ("x", "y", "width", "height", "exponent"):
            if not math.isfinite(getattr(self, name)):
                raise InputError("is not finite", "give a number", place=name)
        for name in ("width", "height"):
            if getattr(self, name) < 0.0:
                raise InputError(f"{getattr(self, name):g} is negative", "use more than 0", place=name)
        if (self.width == 0.0) != (self.height == 0.0):
            missing = "width" if self.width == 0.0 else "height"
            raise InputError("0", "give width and height, or neither for a point", place=missing)
        if not _EXPONENTS[0] <= self.exponent <= _EXPONENTS[1]:
            remedy = f"use {_EXPONENTS[0]:g} to {_EXPONENTS[1]:g}"
            raise InputError(f"{self.exponent:g} is out of range", remedy, place="exponent")

    @property
    def is_point(self) -> bool:
        """Whether the section is a single point."""
        return self.points is None and self.width == 0.0

    @property
    def middle(self) -> float:
        """The y half way between keel (bottom) and crown (top)."""
        return self.y if self.points is None else self.y + 0.5 * float(self.points[0, 0] + self.points[-1, 0])

    @property
    def halves(self) -> tuple[float, float]:
        """Half the width and half the height of the section."""
        if self.points is None:
            return 0.5 * self.width, 0.5 * self.height
        return float(self.points[:, 1].max()), 0.5 * float(self.points[-1, 0] - self.points[0, 0])

    @cached_property
    def _seen(self) -> tuple[Floats, Floats]:
        """Angles and distances of its points (`shape`)."""
        return _seen(np.asarray(self.points), self.middle - self.y, *self.halves)

    @property
    def shape(self) -> Floats:
        """Distances (ANGLES,) of the curve from the section's middle, at equal angles from keel to crown.

        Lengths along z are divided by half the width, along y by half the height: an ellipse has distances 1.
        """
        even = np.linspace(0.0, math.pi, ANGLES)
        if self.points is not None:
            angles, distances = self._seen
            return CubicTable(distances, angles)(even)
        across, up = np.abs(sin(even)), np.abs(cos(even))
        if self.exponent == 2.0 or self.is_point:
            return np.ones(ANGLES)
        return np.asarray(
            power(power(across, self.exponent) + power(up, self.exponent), -1.0 / self.exponent)
        )


def _half_section(points: Floats) -> Floats:
    """Return points (n, 2) from keel to crown. Raises InputError: they are not half a section."""
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < _FEWEST_POINTS:
        raise InputError(f"points of shape {points.shape}", f"give {_FEWEST_POINTS} or more points y, z")
    if not np.isfinite(points).all():
        raise InputError("a point is not finite", "check it for NaN or infinity")
    points = points[::-1].copy() if points[0, 0] > points[-1, 0] else points.copy()
    width = float(points[:, 1].max())
    if width <= 0.0 or np.abs(points[[0, -1], 1]).max() > _IN_PLANE * width:
        problem = f"ends at z={points[0, 1]:g} and z={points[-1, 1]:g}"
        raise InputError(problem, "give the half z >= 0, from keel to crown, both in z = 0")
    points[[0, -1], 1] = 0.0
    wrong = np.flatnonzero(points[1:-1, 1] <= 0.0)
    if len(wrong):
        raise InputError(f"z={points[wrong[0] + 1, 1]:g} at point {wrong[0] + 2}", "give the half z >= 0")
    same = np.flatnonzero(norms(np.diff(points, axis=0)) <= 0.0)
    if len(same):
        at = int(same[0]) + 1
        raise InputError(f"points {at} and {at + 1} are the same", "leave one of them out")
    turns = np.abs(turning(_mirrored(points)))[len(points) - 1 : 2 * len(points) - 1]
    if turns.max() > _MOST_TURN:
        problem = f"turns by {math.degrees(turns.max()):.0f} degrees at point {int(turns.argmax()) + 1}"
        raise InputError(problem, "give more points, on a rounded corner")
    return points


def _mirrored(points: Floats) -> Floats:
    """Return points (3 n - 2, 2) of a half section between those of the other half."""
    other = points[::-1] * [1.0, -1.0]
    return np.concatenate([other[:-1], points, other[1:]])


def _seen(points: Floats, middle: float, across: float, up: float) -> tuple[Floats, Floats]:
    """Return angles and distances on a spline through the points of a section, from its middle."""
    ring = _mirrored((points - [middle, 0.0]) / [up, across])
    arcs = arc_lengths(ring)
    first, count = len(points) - 1, len(points)
    steps = np.arange((count - 1) * _DENSE + 1) / _DENSE + first
    y, z = CubicTable(ring, arcs)(np.interp(steps, np.arange(len(ring)), arcs)).T
    angles = arctan2(z, -y)
    angles[[0, -1]] = 0.0, math.pi
    back = np.flatnonzero(np.diff(angles) <= 0.0)
    if len(back):
        at = int(back[0]) // _DENSE
        problem = f"a ray from its middle meets it twice, at points {at + 1} and {at + 2}"
        raise InputError(problem, "give a section without a hollow there", place="points")
    return angles, np.sqrt(y * y + z * z)
