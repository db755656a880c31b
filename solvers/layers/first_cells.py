"""How high the first cells off each edge are to be, and the laws by which the others grow."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import LARGEST
from meshonet.kernels._native import layer_steps


@dataclass(frozen=True)
class Heights:
    """Heights of the first cells off the edges, 0 for edges that ask for none.

    Parameters
    ----------
    south, north, west, east : in the unit of the boundary.
    constant : so many first cells have that height; beyond, they grow by one ratio.
    growth : largest ratio of neighbouring cells allowed, None for any up to 10.
    free_rows : take as many rows off south and north as `growth` needs, instead of those of the boundary.

    Raises
    ------
    InputError
        a height, a number of layers or a growth out of range.
    """

    south: float = 0.0
    north: float = 0.0
    west: float = 0.0
    east: float = 0.0
    constant: int = 1
    growth: float | None = None
    free_rows: bool = False

    def __post_init__(self) -> None:
        for side in SIDES:
            height = getattr(self, side)
            if not (math.isfinite(height) and height >= 0):
                raise InputError(f"a first cell of {height:g} off {side}", "give a positive height")
        if self.constant < 1:
            raise InputError(f"{self.constant} constant layers", "give at least 1")
        if self.growth is not None and not 1.0 < self.growth <= LARGEST:
            raise InputError(
                f"a growth of {self.growth:g}",
                f"give the ratio of neighbouring cells, such as 1.15, at most {LARGEST:g}",
            )

    @property
    def any(self) -> bool:
        """Whether an edge asks for a height."""
        return bool(self.south or self.north or self.west or self.east)

    def told(self) -> str:
        """Return the heights for people."""
        asked = {side: getattr(self, side) for side in SIDES if getattr(self, side)}
        return ", ".join(f"{height:.6g} off {side}" for side, height in asked.items())


def check_fit(heights: Heights, boundary: Boundary) -> None:
    """Raise InputError when `boundary` cannot have the heights: wrong edges, cells too few or too high."""
    if boundary.around_body and (heights.north or heights.west or heights.east):
        raise InputError(
            f"a spacing off north, west or east in topology {boundary.topology}",
            "give that of its wall, south",
        )
    for one, other, sides, count in (
        ("south", "north", ("west", "east"), boundary.nj),
        ("west", "east", ("south", "north"), boundary.ni),
    ):
        heights_here = [height for side in (one, other) if (height := getattr(heights, side))]
        if not heights_here:
            continue
        free = heights.free_rows and one == "south"
        needed = heights.constant * len(heights_here) + 2
        if count < needed and not free:
            raise InputError(f"{count} nodes off {one} are too few for layers", f"use at least {needed}")
        for side in sides:
            edge = getattr(boundary, side)
            length = float(np.hypot(*np.diff(edge, axis=0).T).sum())
            if heights.constant * sum(heights_here) >= 0.9 * length:
                told = " and ".join(f"{height:g}" for height in heights_here)
                raise InputError(
                    f"first cells of {told} fill {side}, which is {length:.3g} long",
                    "use smaller ones or fewer constant layers",
                )


def cells_needed(length: float, first: float, last: float, heights: Heights) -> int:
    """Return the fewest cells that fill `length` growing by no more than `heights.growth`."""
    least = heights.constant * ((first > 0) + (last > 0)) + 1
    allowed = heights.growth or LARGEST
    count = least
    while layer_ratio(count, length, first, last, heights.constant) > allowed * (1 + 1e-9):
        count = max(count + 1, int(1.02 * count))
        if count > 100_000:
            raise InputError(f"cells growing by {allowed:g} do not fill {length:.3g}", "allow more growth")
    return count


def layer_ratio(cells: int, length: float, first: float, last: float, constant: int) -> float:
    """Return the largest ratio of neighbours when `cells` cells fill `length`, infinite when they cannot."""
    return layer_steps(np.empty(cells), length, first, last, constant)


def edge_in_layers(edge: Floats, count: int, first: float, last: float, heights: Heights) -> Floats:
    """Return `count` nodes (count, 2) on the curve through an open edge, in layers at its ends.

    The distance of the first two nodes is `first` and that of the last two `last`, where these are not 0.
    """
    curve = Curve(edge)
    nodes = curve.at(arcs_in_layers(curve, count, first, last, heights)[0])
    nodes[0], nodes[-1] = edge[0], edge[-1]
    return nodes


def arcs_in_layers(
    curve: Curve, count: int, first: float, last: float, heights: Heights
) -> tuple[Floats, float]:
    """Return arc lengths (count,) on an open curve, in layers at its ends, and the largest ratio of steps."""
    steps = np.empty(count - 1)
    begin = _arc_at(curve, 0.0, first) if first else 0.0
    end = _arc_at(curve, curve.length, last) if last else 0.0
    ratio = layer_steps(steps, curve.length, begin, end, heights.constant)
    half = (count - 1) // 2
    arcs = np.empty(count)
    arcs[: half + 1] = np.concatenate([[0.0], np.cumsum(steps[:half])])
    arcs[half + 1 :] = curve.length - np.concatenate([np.cumsum(steps[:half:-1])[::-1], [0.0]])
    return arcs, ratio


def _arc_at(curve: Curve, origin: float, distance: float) -> float:
    """Return how far along the curve from its end at `origin` a point lies `distance` away from that end."""
    sign = 1.0 if origin == 0.0 else -1.0
    home = curve.points[0 if origin == 0.0 else -1]
    arc = distance
    for _ in range(30):
        found = float(np.hypot(*(curve.at(np.array([origin + sign * arc]))[0] - home)))
        if abs(found / distance - 1.0) < 1e-14:
            break
        arc *= distance / found
    return arc
