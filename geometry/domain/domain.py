"""A region of the plane: inside an outer loop, outside of holes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, extent_of
from meshonet.geometry.blocks.patches import may_be_wall
from meshonet.geometry.cached import cached_property
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.domain.ring import ring_loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area

_PARTS = np.linspace(0.0, 1.0, 8, endpoint=False)  # of an interval of a curve, to measure its area


@dataclass(frozen=True, eq=False)
class Domain:
    """A region of the plane, bounded by closed curves (loops).

    Parameters
    ----------
    loops : tuple of Loop
        The outer loop, followed by the holes. The domain is on the left of each loop.
    name : str, optional
        Name of the shape in the input.
    notes : tuple of str, optional
        Notes on parts of the file that were ignored.
    periodic : tuple of Periodic, optional
        Pairs of periodic parts of the outer loop.
    heights, counts : mapping, optional
        Prescribed first-cell heights and numbers of cells along a part of a loop, by the name of this part. A
        mirror symmetry is used only if parts that are mirror images have equal prescribed values.

    Raises
    ------
    InputError
        No loop.
    """

    loops: tuple[Loop, ...]
    name: str = ""
    notes: tuple[str, ...] = ()
    periodic: tuple[Periodic, ...] = ()
    heights: Mapping[str, float] = field(default_factory=dict)
    counts: Mapping[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not self.loops:
            raise InputError("a domain without a loop", "give an outer loop")

    @classmethod
    def of_polygons(
        cls, polygons: Sequence[Floats], name: str = "", names: Sequence[str | Sequence[str]] = ()
    ) -> Self:
        """Return the domain inside the first polygon and outside all further polygons.

        Parameters
        ----------
        polygons : sequence of array (n, 2)
            Points of each polygon, in either direction. Turns of more than 30 degrees are corners.
        name : str, optional
            Name of the domain.
        names : sequence, optional
            For each polygon one name, or a list of names of its parts between corners, from the first corner
            on, in the order of the points. Default: ``outer``, ``body``, ``body2`` ...

        Raises
        ------
        InputError
            The number of names differs from the number of polygons, or of the parts of a polygon.

        Examples
        --------
        >>> import numpy as np
        >>> box = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]])
        >>> sides = ["floor", "outlet", "ceiling", "inlet"]
        >>> Domain.of_polygons([box], "channel", [sides]).loops[0].names
        ('floor', 'outlet', 'ceiling', 'inlet')
        """
        if names:
            return cls(_named(polygons, names), name)
        loops = []
        for number, points in enumerate(polygons):
            own = ("outer",) if number == 0 else ("body" if number == 1 else f"body{number}",)
            left = polygon_area(points) > 0
            loops.append(Loop.of_polygon(points if left == (number == 0) else points[::-1], names=own))
        return cls(tuple(loops), name)

    @cached_property
    def area(self) -> float:
        """Area of the domain, computed from the polygons through the points of its loops."""
        return float(sum(polygon_area(loop.curve.points) for loop in self.loops))

    @property
    def curved_areas(self) -> list[float]:
        """Area within the curve of each loop, not within the polygon through its points; < 0 for holes."""
        return [float(polygon_area(loop.curve.polyline(_PARTS))) for loop in self.loops]

    @cached_property
    def lengths(self) -> Floats:
        """Arc lengths (loops,) of the loops."""
        return np.array([loop.length for loop in self.loops])

    def at(self, loop: Indices, arc: Floats) -> Floats:
        """Return the points (n, 2) at arc lengths `arc` (n,) on the loops with the indices `loop` (n,)."""
        points = np.empty((len(loop), 2))
        for number, each in enumerate(self.loops):
            points[loop == number] = each.at(arc[loop == number])
        return points

    @cached_property
    def layered_loops(self) -> range:
        """Indices of the loops that get layers if no wall is named: holes or, in a channel, the outer loop.

        A channel has no holes or periodic sides, and a part of its boundary, such as ``inlet``, is no wall.
        """
        alone = len(self.loops) == 1 and not self.periodic
        channel = alone and not all(map(may_be_wall, self.loops[0].names))
        return range(0 if channel else 1, len(self.loops))

    @cached_property
    def extent(self) -> float:
        """Larger side of the bounding box of the domain."""
        return extent_of(self.loops[0].curve.points)


def _named(polygons: Sequence[Floats], names: Sequence[str | Sequence[str]]) -> tuple[Loop, ...]:
    if len(names) != len(polygons):
        raise InputError(f"names of {len(names)} polygons, and {len(polygons)} polygons", "name each of them")
    called = [(own,) if isinstance(own, str) else tuple(own) for own in names]
    return tuple(
        ring_loop(points, hole=number > 0, names=own)
        for number, (points, own) in enumerate(zip(polygons, called, strict=True))
    )
