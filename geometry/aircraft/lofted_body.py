"""A body through cross-sections, such as a fuselage with an oval cabin and a raised tail."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.body_section import ANGLES, BodySection
from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.curves.cubic import LimitedSpline
from meshonet.geometry.curves.monotone import hermite_piece
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.ties import first_least
from meshonet.kernels._native import lattice_values

_FLATTEST = 3.5  # largest width of a section over its height, or the reverse
_FEWEST = 4
_LONGEST = 0.1  # largest distance of sections, in body lengths, without points of the meridian between them


@dataclass(frozen=True, eq=False)
class LoftedBody(Body):
    """A body given by cross-sections, with a spline surface through them.

    The section at x has the points (x, middle - up * shape * cos(theta), across * shape * sin(theta)). The
    angle theta is 0 at the keel (-y) and pi at the crown (+y). `across` is half the width of the section,
    `up` half its height, `middle` the y half way between keel and crown, and `shape` a factor, which is 1 for
    an ellipse. The attributes ``meridian`` and ``y`` describe a similar body of revolution, whose radius is
    the mean of `across` and `up`. Positions along the body are given as arc lengths s of this meridian.

    Parameters
    ----------
    name : str, optional
        Name of the body and of its patches.
    sections : tuple of BodySection
        Sections from nose to tail; the first and the last are single points.

    Raises
    ------
    InputError
        Fewer than 4 sections; x that does not increase; a first or last section that is not a single point;
        another section that is a single point; a very flat section; sections so different and far apart that
        the surface bulges between them.

    Examples
    --------
    >>> from meshonet import BodySection, LoftedBody
    >>> oval = [BodySection(x, width=1.4, height=1.2) for x in (1.0, 3.0, 5.0)]
    >>> body = LoftedBody(sections=(BodySection(0.0), *oval, BodySection(8.0, y=0.3)))
    >>> round(body.width, 6), round(body.height, 6)
    (1.4, 1.2)
    """

    meridian: Floats = field(init=False)
    y: float = field(init=False)
    sections: tuple[BodySection, ...] = ()

    def __post_init__(self) -> None:
        if len(self.sections) < _FEWEST:
            problem = f"{len(self.sections)} sections"
            raise InputError(problem, f"give {_FEWEST} or more, nose and tail too", place="sections")
        for number, section in enumerate(self.sections):
            self._refuse_misplaced(number, section)
        radii = [0.5 * sum(section.halves) for section in self.sections]
        largest = first_least(range(len(radii)), lambda k: -radii[k])
        object.__setattr__(self, "y", self.sections[largest].middle)
        x, across, up = self._sizes
        object.__setattr__(self, "meridian", np.stack([x, 0.5 * (across + up)], axis=1))
        super().__post_init__()

    def _refuse_misplaced(self, number: int, section: BodySection) -> None:
        """Raise InputError for a section in the wrong place or of the wrong form."""
        at, before = f"sections[{number}]", self.sections[number - 1]
        if number and section.x <= before.x:
            problem = f"{section.x:g} is not behind {before.x:g}"
            raise InputError(problem, "give the sections from nose to tail", place=f"{at}.x")
        end = number in (0, len(self.sections) - 1)
        if end and not section.is_point:
            problem = "the nose is no point" if number == 0 else "the tail is no point"
            raise InputError(problem, "leave out its width, height and points", place=at)
        if not end and section.is_point:
            raise InputError("a point within the body", "give its width and height", place=f"{at}.width")
        if not end and not 1.0 / _FLATTEST <= section.halves[0] / section.halves[1] <= _FLATTEST:
            across, up = section.halves
            problem = f"a section {2.0 * across:g} wide and {2.0 * up:g} high"
            raise InputError(problem, f"use at most {_FLATTEST:g} times as much of one", place=at)

    def _wild(self, at: int) -> InputError:
        problem = "the surface between it and the next one turns back, bulges or closes"
        number = int(np.searchsorted(self._at, at, side="right")) - 1
        return InputError(problem, "give more sections between them", place=f"sections[{number}]")

    @cached_property
    def _at(self) -> Indices:
        """(n,) indices of the points of the meridian at sections."""
        return np.searchsorted(self.meridian[:, 0], self._at_sections[:, 0])

    @property
    def arcs(self) -> Floats:
        """Arc lengths (n,) of the meridian at the sections."""
        return self.arc[self._at]

    @property
    def width(self) -> float:
        """Largest width of a section."""
        return 2.0 * float(self._at_sections[:, 1].max())

    @property
    def height(self) -> float:
        """Largest height of a section."""
        return 2.0 * float(self._at_sections[:, 2].max())

    @cached_property
    def _at_sections(self) -> Floats:
        """x, half the width and half the height (n, 3) of sections."""
        return np.array([(section.x, *section.halves) for section in self.sections])

    @cached_property
    def _sizes(self) -> Floats:
        """x, half the width and half the height (3, m) at points of the meridian."""
        return _denser(self._at_sections).T

    @cached_property
    def _flatness(self) -> LimitedSpline:
        """Half the width over the radius of sections; at nose and tail that of the section beside."""
        inner = self._sizes[1, 1:-1] / self.meridian[1:-1, 1]
        return LimitedSpline(np.concatenate([inner[:1], inner, inner[-1:]]), self.arc)

    @cached_property
    def _middle(self) -> LimitedSpline:
        return LimitedSpline(np.array([section.middle for section in self.sections]), self._at_sections[:, 0])

    @cached_property
    def _shapes(self) -> Floats:
        """Shapes (n, ANGLES, 2) of the sections, and their derivatives by s."""
        spline = LimitedSpline(np.array([section.shape for section in self.sections]), self.arcs)
        return np.ascontiguousarray(np.stack([spline.values, spline.slopes], axis=-1))

    def sizes(self, s: Floats) -> tuple[Floats, Floats, Floats]:
        """Return half the width, half the height and the y of the middle, each (n,), at arc lengths `s`."""
        x, radius = self.meridional(s).T
        flatness = self._flatness(s)
        return radius * flatness, radius * (2.0 - flatness), self._middle(x)

    def shape(self, s: Floats, theta: Floats) -> Floats:
        """Return radii (n,) of sections, divided by those of ellipses of the same width and height.

        `s` (n,) are arc lengths of the meridian from the nose. `theta` (n,) are angles in radians, 0 at the
        keel (-y); see the class.
        """
        arcs = self.arcs
        before = np.clip(np.searchsorted(arcs, s, side="right") - 1, 0, len(arcs) - 2)
        h = arcs[before + 1] - arcs[before]
        theta = np.abs(theta)
        across: Floats = np.where(theta > np.pi, 2.0 * np.pi - theta, theta) * ((ANGLES - 1) / np.pi)
        ends = np.empty((2, len(s), 2))
        for number, values in enumerate(ends):
            lattice_values(self._shapes, (before + number).astype(np.float64), across, values)
        (start, begin), (stop, end) = np.moveaxis(ends, -1, 1)
        return hermite_piece((s - arcs[before]) / h, start, stop, h * begin, h * end)

    def points(self, s: Floats, theta: Floats) -> Floats:
        """Return points (..., 3) of the surface.

        `s` (...) are arc lengths of the meridian from the nose. `theta` (...) are angles in radians, 0 at the
        keel (-y); see the class.
        """
        s, theta = np.broadcast_arrays(s, theta)
        arcs, angles = s.ravel(), theta.ravel()
        across, up, middle = self.sizes(arcs)
        shape = self.shape(arcs, angles)
        y, z = middle - up * shape * cos(angles), across * shape * sin(angles)
        return np.stack([self.meridional(arcs)[:, 0], y, z], axis=-1).reshape(*s.shape, 3)

    def outside(self, points: Floats) -> Floats:
        """Return radial distances (n,) of `points` (n, 3) from the surface; negative inside the body."""
        s = self.arc_at(points[:, 0])
        across, up, middle = self.sizes(s)
        y, z = points[:, 1] - middle, np.abs(points[:, 2])
        angles = arctan2(z * up, -y * across)
        shape = self.shape(s, angles)
        return np.asarray(np.hypot(y, z) - shape * np.hypot(up * cos(angles), across * sin(angles)))

    def beside(self, point: Floats) -> str:
        """Return a text with the size of the section at the x of a `point` (3,)."""
        across, up, middle = (float(each[0]) for each in self.sizes(self.arc_at(point[:1])))
        low, high = middle - up, middle + up
        return f"where its section is from y={low:.4g} to {high:.4g} and {2.0 * across:.4g} wide"


def _denser(sections: Floats) -> Floats:
    """Return x, half the width and half the height (m, 3): `sections` (n, 3) and more in long intervals.

    They are on splines of squares, for round noses and tails; steps shrink towards these.
    """
    x, halves = sections[:, 0], sections[:, 1:]
    squares = LimitedSpline(halves * halves, x)
    counts = np.ceil(np.diff(x) / (_LONGEST * np.ptp(x))).astype(int).tolist()
    rows = []
    for number, count in enumerate(counts):
        part = np.arange(1, count) / count
        if number == 0:
            part = part * part
        elif number == len(counts) - 1:
            part = part * (2.0 - part)
        within = x[number] + part * (x[number + 1] - x[number])
        rows += [sections[number : number + 1], np.column_stack([within, np.sqrt(squares(within))])]
    return np.concatenate([*rows, sections[-1:]])
