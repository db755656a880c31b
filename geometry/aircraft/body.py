"""A body of revolution, such as a fuselage, from its meridian."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats, arc_lengths
from meshonet.geometry.curves.cubic import CubicTable
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError, in_place

_STEPS = 6
_SMALLEST = 1e-9  # least length of a body, in any unit
_BETWEEN = 8  # parts of an interval between points in which the spline is checked
_TURNED = 0.01  # part of the length by which x may lie before or behind the points around it
_BULGED = 1.5  # largest radius over that of the points
_FLAT = 1e-6  # smallest dx/ds at which Newton's method is used; dx/ds is 0 at a blunt nose


@dataclass(frozen=True, eq=False)
class Body:
    """A body of revolution about an axis parallel to x, in the plane of symmetry z = 0.

    s is the arc length of the meridian, 0 at the nose; theta is 0 at the keel (-y) and pi at the crown (+y).

    Parameters
    ----------
    meridian : array
        Points (n, 2) of x and radius from nose to tail; x increases, and the radius is 0 at both ends.
    y : float, optional
        The y of the axis.
    name : str, optional
        Name of the body and of its patches.

    Raises
    ------
    InputError
        Fewer than 4 points; x that does not increase; radii that are negative, or not 0 at both ends; points
        so far apart that a spline through them turns back or bulges; control characters in a name.

    Examples
    --------
    >>> from meshonet import Body
    >>> Body([[0, 0], [0.1, 0.3], [2, 0.6], [6, 0.6], [10, 0]]).radius
    0.6
    """

    meridian: Floats
    y: float = 0.0
    name: str = "fuselage"

    def __post_init__(self) -> None:
        if not self.name.isprintable():
            raise InputError(f"{self.name!r} has control characters", "leave them out", place="name")
        points = np.asarray(self.meridian, dtype=np.float64)
        with in_place("meridian"):
            _refuse_open(points)
        object.__setattr__(self, "meridian", points)
        self._refuse_wild_spline()

    def _refuse_wild_spline(self) -> None:
        """Raise InputError if the spline turns back or bulges between distant points."""
        parts = np.arange(len(self.arc) - 1)[:, None] + np.arange(1, _BETWEEN) / _BETWEEN
        s = np.interp(parts.ravel(), np.arange(len(self.arc)), self.arc)
        x, r = self._spline(s).reshape(len(self.arc) - 1, _BETWEEN - 1, 2).transpose(2, 0, 1)
        low, high = self.meridian[:-1, :1], self.meridian[1:, :1]
        back = np.maximum(low - x, x - high).max(axis=1) > _TURNED * self.extent
        wild = back | (r.max(axis=1) > _BULGED * self.radius) | (r.min(axis=1) <= 0.0)
        leaving = self._spline.slope(self.arc[[0, -1]])[:, 1] * [1.0, -1.0]
        wild[[0, -1]] |= leaving <= 0.0
        wild = np.flatnonzero(wild)
        if len(wild):
            raise self._wild(int(wild[0]))

    def _wild(self, at: int) -> InputError:
        problem = "the spline through the meridian turns back, bulges or reaches the axis"
        place = f"meridian: points {at + 1} and {at + 2}"
        return InputError(problem, "give more points between them", place=place)

    @cached_property
    def arc(self) -> Floats:
        """Arc lengths (n,) at the points of the meridian, measured along straight lines between them."""
        return arc_lengths(self.meridian)

    @cached_property
    def _spline(self) -> CubicTable:
        return CubicTable(self.meridian, self.arc)

    @property
    def length(self) -> float:
        """Arc length of the whole meridian."""
        return float(self.arc[-1])

    @property
    def extent(self) -> float:
        """Length along the axis."""
        return float(np.ptp(self.meridian[:, 0]))

    @property
    def radius(self) -> float:
        """Greatest radius of the body."""
        return float(self.meridian[:, 1].max())

    @property
    def width(self) -> float:
        """The greatest width of a section."""
        return 2.0 * self.radius

    @property
    def height(self) -> float:
        """The greatest height of a section."""
        return 2.0 * self.radius

    def meridional(self, s: Floats) -> Floats:
        """Return x and radius (n, 2) of the meridian at arc lengths `s` (n,)."""
        x, r = self._spline(s).T
        return np.stack([x, np.maximum(r, 0.0)], axis=1)

    def points(self, s: Floats, theta: Floats) -> Floats:
        """Return points (..., 3) of the surface.

        `s` (...) are arc lengths of the meridian from the nose. `theta` (...) are angles about the axis in
        radians, 0 at the keel (-y).
        """
        s, theta = np.broadcast_arrays(s, theta)
        x, r = np.moveaxis(self._spline(s.ravel()).reshape(*s.shape, 2), -1, 0)
        r = np.maximum(r, 0.0)
        return np.stack([x, self.y - r * cos(theta), r * sin(theta)], axis=-1)

    def arc_at(self, x: Floats) -> Floats:
        """Return arc lengths (n,) of the meridian at positions `x` (n,), which are clipped to the body."""
        x = np.clip(x, self.meridian[0, 0], self.meridian[-1, 0])
        s = monotone_cubic(self.meridian[:, 0], self.arc, x, linear=True)
        for _ in range(_STEPS):  # Newton's method
            slope = self._spline.slope(s)[:, 0]
            step = (self._spline(s)[:, 0] - x) / np.where(slope > _FLAT, slope, np.inf)
            before, s = s, np.clip(s - step, 0.0, self.length)
            if (s == before).all():  # as would be all that follow
                break
        return np.asarray(s)

    def arcs_near(self, points: Floats) -> Floats:
        """Return, as arc lengths (n,), the places on the meridian nearest to `points` (n, 2).

        A point is given as x and radius. The points are in order from nose to tail.
        """
        s = arc_lengths(points)
        s *= self.length / s[-1]
        for _ in range(_STEPS):  # Newton's method for the foot of each point
            off, along = points - self._spline(s), self._spline.slope(s)
            s = np.clip(s + (off * along).sum(axis=1) / (along * along).sum(axis=1), 0.0, self.length)
        s[0], s[-1] = 0.0, self.length
        return s

    def outside(self, points: Floats) -> Floats:
        """Return the radial distances (n,) of `points` (n, 3) from the surface; negative inside the body."""
        r = self._spline(self.arc_at(points[:, 0]))[:, 1]
        return np.asarray(np.hypot(points[:, 1] - self.y, points[:, 2]) - r)

    def beside(self, point: Floats) -> str:
        """Return the distance of `point` (3,) from the axis and the radius at its x, in words."""
        away, radius = np.hypot(point[1] - self.y, point[2]), float(np.interp(point[0], *self.meridian.T))
        return f"{away:.4g} from its axis, where its radius is {radius:.4g}"


def _refuse_open(points: Floats) -> None:
    """Raise InputError for points that are not a meridian."""
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < 4:
        raise InputError(f"a meridian of shape {points.shape}", "give 4 or more points x, r")
    if not np.isfinite(points).all():
        raise InputError("a point is not finite", "check it for NaN or infinity")
    back = np.flatnonzero(np.diff(points[:, 0]) <= 0.0)
    if len(back):
        problem = f"x is {points[back[0] + 1, 0]:g} behind {points[back[0], 0]:g}"
        place = f"meridian: point {back[0] + 2}"
        raise InputError(problem, "give the meridian from nose to tail", place=place)
    wrong = np.flatnonzero(points[1:-1, 1] <= 0.0)
    if len(wrong):
        place = f"meridian: point {wrong[0] + 2}"
        raise InputError(f"a radius of {points[wrong[0] + 1, 1]:g}", "use more than 0", place=place)
    if points[0, 1] != 0.0 or points[-1, 1] != 0.0:
        problem = f"radii of {points[0, 1]:g} and {points[-1, 1]:g} at nose and tail"
        raise InputError(problem, "close the meridian: radius 0 at its first and last point")
    if np.ptp(points[:, 0]) < _SMALLEST:
        raise InputError(f"{np.ptp(points[:, 0]):g} long", "use a larger unit")
