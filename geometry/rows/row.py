"""A row of blades, from which the grid of a passage is made."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Integral, Real

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.cached import cached_property
from meshonet.geometry.errors import InputError, in_place
from meshonet.geometry.rows.blade import BladeSurface
from meshonet.geometry.rows.channel import Channel
from meshonet.geometry.rows.frame import UNITS
from meshonet.geometry.rows.profile_points import as_points

FEWEST, MOST = 2, 1000
"""Smallest and largest number of blades of a row."""


@dataclass(frozen=True, eq=False)
class Row:
    """A row of equal blades between hub and casing, around the x axis.

    Parameters
    ----------
    profiles : sequence of array
        Two or more closed curves (n, 3) of x, y, z around one blade, from hub to casing.
    hub, shroud : array
        Points (n, 2) of x and r on the inner and the outer wall, from inlet to outlet.
    blades : int
        Number of blades.
    tip_gap, hub_gap : float, optional
        Widths of the gaps between blade and casing, and between blade and hub.
    name : str, optional
        Name of the row.
    notes : tuple of str, optional
        Notes on changes of the profiles.
    frame : Motion, optional
        Rotation from the coordinates of the grid to the coordinates of the row; None: no rotation.
    unit : {'m', 'cm', 'mm', 'in', 'ft'}, optional
        Unit in which reports give lengths, for a row in metres. Empty: reports give lengths as the row does.

    Raises
    ------
    InputError
        Walls that form no channel; profiles in wrong order or outside the channel; gaps wider than the span.

    Examples
    --------
    Ellipses on two cylinders, thicker at the hub:

    >>> import numpy as np
    >>> t = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    >>> profiles = []
    >>> for radius, thickness in ((0.5, 0.012), (0.8, 0.008)):
    ...     x, angle = 0.1 * np.cos(t), 0.5 * thickness * np.sin(t) / radius
    ...     profiles.append(np.stack([x, radius * np.sin(angle), radius * np.cos(angle)], axis=1))
    >>> hub, shroud = [[-0.3, 0.5], [0.4, 0.5]], [[-0.3, 0.8], [0.4, 0.8]]
    >>> row = Row(profiles, hub, shroud, blades=16, tip_gap=0.003)
    >>> round(row.chord, 3)
    0.2
    """

    profiles: Sequence[Floats]
    hub: Floats
    shroud: Floats
    blades: int
    tip_gap: float = 0.0
    hub_gap: float = 0.0
    name: str = "row"
    notes: tuple[str, ...] = ()
    frame: Motion | None = None
    unit: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.blades, Integral) or not FEWEST <= self.blades <= MOST:
            remedy = f"use a whole number from {FEWEST} to {MOST}"
            raise InputError(f"{self.blades} blades", remedy, place="blades")
        if len(self.profiles) < 2:
            remedy = "give two or more, from hub to casing, with a blank line or text between them in a file"
            raise InputError(f"{len(self.profiles)} of a blade", remedy, place="profiles")
        for place, gap in (("tip_gap", self.tip_gap), ("hub_gap", self.hub_gap)):
            if not isinstance(gap, Real) or not 0.0 <= gap < math.inf:
                remedy = "use a number, 0 or more, in the unit of the points"
                raise InputError(f"{gap!r} is no width of a gap", remedy, place=place)
        if self.unit and self.unit not in UNITS:
            raise InputError(f"unit {self.unit!r}", f"use {', '.join(UNITS)}", place="unit")
        for place in ("hub", "shroud"):
            with in_place(place):
                object.__setattr__(self, place, as_points(getattr(self, place), 2))
        profiles = []
        for number, points in enumerate(self.profiles, start=1):
            with in_place(f"profile {number}"):
                profiles.append(as_points(points, 3))
        object.__setattr__(self, "profiles", tuple(profiles))
        self.surface.check_pitch()

    @cached_property
    def channel(self) -> Channel:
        """The channel between hub and casing."""
        return Channel(self.hub, self.shroud, self.hub_gap, self.tip_gap)

    @cached_property
    def surface(self) -> BladeSurface:
        """The surface of the blade."""
        return BladeSurface(self.profiles, self.channel, self.blades)

    @property
    def changes(self) -> tuple[str, ...]:
        """Notes that say how the given profiles were changed."""
        return (*self.notes, *self.surface.notes)

    @property
    def pitch(self) -> float:
        """Angle in radians from a blade to the next."""
        return 2.0 * np.pi / self.blades

    @cached_property
    def chord(self) -> float:
        """Distance from the leading to the trailing edge of the longest profile."""
        squares = []
        for points in self.profiles:
            x, y, z = np.asarray(points).T
            apart = [(each[:, None] - each) ** 2 for each in (x, y, z)]
            squares.append(float((apart[0] + apart[1] + apart[2]).max()))
        return math.sqrt(max(squares))
