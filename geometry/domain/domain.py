"""A region of the plane: inside an outer loop, outside of holes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area


@dataclass(frozen=True)
class Periodic:
    """Two stretches of the outer loop, of which the second is the first moved by `shift`."""

    first: tuple[float, float]
    """Arc lengths where the first stretch starts and ends, in the direction of the loop."""
    second: tuple[float, float]
    shift: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Domain:
    """Loops, the outer one first; the domain is on the left of each.

    Whether loops cross, touch or lie in one another is looked at by `meshonet.geometry.domain.check`.
    """

    loops: tuple[Loop, ...]
    name: str = ""
    notes: tuple[str, ...] = ()
    periodic: Periodic | None = None

    def __post_init__(self) -> None:
        if not self.loops:
            raise InputError("a domain without a loop", "give an outer loop")

    @classmethod
    def of_polygons(cls, polygons: list[Floats], name: str = "") -> Domain:
        """Return the domain inside the first polygon (n, 2) and outside the others, either way round.

        Returns
        -------
        Domain
            The domain inside the first polygon (n, 2) and outside the others, either way round.
        """
        loops = []
        for number, points in enumerate(polygons):
            names = ("outer",) if number == 0 else ("body" if number == 1 else f"body{number}",)
            left = polygon_area(points) > 0
            loops.append(Loop.of_polygon(points if left == (number == 0) else points[::-1], names=names))
        return cls(tuple(loops), name)

    @cached_property
    def area(self) -> float:
        """Area inside the polygons through the points of the loops."""
        return float(sum(polygon_area(loop.curve.points) for loop in self.loops))

    @cached_property
    def extent(self) -> float:
        """Larger side of the box around the domain."""
        return float(np.ptp(self.loops[0].curve.points, axis=0).max())
