"""A closed curve that bounds a domain, with its corners and boundary names."""

from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Bools, Floats, shortest_ways
from meshonet.geometry.cached import cached_property
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.ties import EQUAL

CORNER_DEG = 30.0  # turn in degrees above which a point is a corner, unless the input lists the corners


def turns_sharply(turn: Floats) -> Bools:
    """Return whether |`turn`| (n,), in radians, exceeds `CORNER_DEG` by more than rounding errors."""
    return np.asarray(np.abs(turn) > np.radians(CORNER_DEG) * (1.0 + EQUAL))


@dataclass(frozen=True, eq=False)
class Loop:
    """A closed curve with the domain on its left: an outer loop counter-clockwise, a hole clockwise.

    Parameters
    ----------
    curve : closed curve through the points (n, 2) of the input; arc lengths start at the first point. For a
        polygon it is the polygon itself, for an airfoil a spline between corners.
    corners : ascending indices of the points that are corners. A grid has a node at each.
    names : one name for the whole loop, or one for each part between corners.
    cells : number of cells that should meet at each corner; if empty, the numbers follow from the angles.

    Raises InputError: a corner index that is out of range; the wrong number of names.
    """

    curve: Curve
    corners: tuple[int, ...] = ()
    names: tuple[str, ...] = ("outer",)
    places: tuple[str, ...] = field(default=(), repr=False)
    """Position of each point in the input, such as ``line 12``, for messages; may be empty."""
    cells: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        n = len(self.curve.points)
        if any(not 0 <= k < n for k in self.corners):
            raise InputError(f"corners {self.corners} of a loop of {n} points", f"use 0 to {n - 1}")
        if len(self.names) not in (1, max(len(self.corners), 1)):
            stretches = f"{len(self.names)} names for {max(len(self.corners), 1)} stretches between corners"
            raise InputError(stretches, "give one name, or one for each")

    @classmethod
    def of_polygon(
        cls, points: Floats, corners: tuple[int, ...] | None = None, names: tuple[str, ...] = ("outer",)
    ) -> Self:
        """Return the loop along the polygon `points` (n, 2), which has the domain on its left.

        `corners` are indices of points; None detects them by the turning angle. `names` are as in `Loop`.
        """
        curve = Curve(points, closed=True, corners=(), straight=np.ones(len(points), dtype=bool))
        if corners is None:
            corners = tuple(np.flatnonzero(turns_sharply(turning(curve.points, closed=True))))
        return cls(curve, tuple(int(k) for k in corners), names)

    @property
    def length(self) -> float:
        """Arc length of the whole loop."""
        return self.curve.length

    @cached_property
    def corner_arcs(self) -> Floats:
        """Arc lengths (c,) at the corners."""
        return self.curve.knots[list(self.corners)]

    @property
    def pieces(self) -> tuple[Floats, Floats]:
        """Arc lengths (p,) at which the pieces between corners start, and lengths (p,) of these pieces."""
        starts = self.corner_arcs if self.corners else np.zeros(1)
        return starts, np.diff(starts, append=starts[0] + self.length)

    @cached_property
    def corner_angles(self) -> Floats:
        """Angles (c,) of the domain at the corners in degrees, 0 to 360; above 180 at re-entrant corners."""
        turn = np.degrees(turning(self.curve.points, closed=True))
        return np.asarray(180.0 - turn[list(self.corners)])

    @cached_property
    def corner_cells(self) -> NDArray[np.intp]:
        """Number of cells (c,) that should meet at each corner, 1 to 4: about one per 90 degrees.

        Corners of 135 and of 225 degrees get two cells.
        """
        if self.cells:
            return np.array(self.cells, dtype=np.intp)
        halves_to_even = np.round(np.round(self.corner_angles / 90.0, 9))
        return np.clip(halves_to_even, 1, 4).astype(np.intp)

    def at(self, arc: Floats) -> Floats:
        """Return the points (m, 2) at arc lengths `arc` (m,), taken modulo the length of the loop."""
        return self.curve.at(np.mod(arc, self.length))

    def tangent(self, arc: Floats) -> Floats:
        """Return unit tangents (m, 2) at arc lengths `arc` (m,); at a corner, the tangent just after it."""
        return self.curve.tangent(np.mod(arc, self.length))

    def name_at(self, arc: float) -> str:
        """Return the name of the part of the loop that contains an arc length."""
        if len(self.names) == 1:
            return self.names[0]
        stretch = int(np.searchsorted(self.corner_arcs, arc % self.length, side="right")) - 1
        return self.names[stretch]

    def steps(self, arcs: Floats, ways: Floats | float) -> Floats:
        """Return the signed arc lengths (n - 1,) from node to node; `arcs` (n,) are the nodes' arc lengths.

        `ways` is 1 if the nodes are in the loop's direction, -1 if they are in the opposite direction.
        """
        step = shortest_ways(np.diff(arcs), self.length)
        return np.where(step * ways < -EQUAL * self.length, step + ways * self.length, step)

    def sample(self, count: int) -> Floats:
        """Return `count` points (count, 2) at equal steps of arc length."""
        return self.at(np.linspace(0.0, self.length, count, endpoint=False))
