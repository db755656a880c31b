"""First-cell heights at the edges of a block, and cells that grow from them by a constant ratio."""

import math
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import LARGEST, check_growth
from meshonet.kernels._native import layer_steps


@dataclass(frozen=True)
class Heights:
    """First-cell heights at the four edges of a block; 0 if none is prescribed.

    Raises InputError if a height, `constant` or `growth` is out of range.
    """

    south: float = 0.0  # in the unit of the boundary
    north: float = 0.0
    west: float = 0.0
    east: float = 0.0
    constant: int = 1  # number of first cells with that height; those beyond grow by one ratio
    growth: float | None = None  # largest allowed ratio of neighbouring cells; None: 10
    free_rows: bool = False  # whether the number of rows off south and north follows from `growth`

    def __post_init__(self) -> None:
        for side in SIDES:
            height = getattr(self, side)
            if not (math.isfinite(height) and height >= 0):
                raise InputError(f"a first cell of {height:g} off {side}", "give a positive height")
        if self.constant < 1:
            problem = f"{self.constant} constant layers"
            raise InputError(problem, "give at least 1", parameter="constant_layers")
        check_growth(self.growth)

    @property
    def by_side(self) -> dict[str, float]:
        """The prescribed heights, by side."""
        return {side: height for side in SIDES if (height := getattr(self, side))}

    @property
    def any(self) -> bool:
        """Whether any height is prescribed."""
        return bool(self.by_side)

    def __str__(self) -> str:
        return ", ".join(f"{height:.6g} off {side}" for side, height in self.by_side.items())


def check_fit(heights: Heights, boundary: Boundary) -> None:
    """Raise InputError if `heights` do not fit `boundary`: wrong sides, too few cells, too large heights."""
    if boundary.around_body and (heights.north or heights.west or heights.east):
        raise InputError(
            f"a spacing off north, west or east in topology {boundary.topology}",
            "give that of its wall, south",
        )
    for walls, sides, count in (
        (("south", "north"), ("west", "east"), boundary.nj),
        (("west", "east"), ("south", "north"), boundary.ni),
    ):
        here = [height for side in walls if (height := getattr(heights, side))]
        needed = heights.constant * len(here) + 2
        if here and count < needed and not (heights.free_rows and "south" in walls):
            raise InputError(f"{count} nodes off {walls[0]} are too few for layers", f"use at least {needed}")
        for side in sides if here else ():
            length = float(np.hypot(*np.diff(getattr(boundary, side), axis=0).T).sum())
            if heights.constant * sum(here) >= 0.9 * length:
                sizes = " and ".join(f"{height:g}" for height in here)
                raise InputError(
                    f"first cells of {sizes} fill {side}, which is {length:.3g} long",
                    "use smaller ones or fewer constant layers",
                )


def cells_needed(length: float, first: float, last: float, heights: Heights) -> int:
    """Return how many cells fill `length` with growth ratios of at most `heights.growth`.

    `first` and `last` are the lengths of the first and of the last cell; 0: the length is not prescribed.
    Raises InputError if 100,000 cells are too few.
    """
    least = heights.constant * ((first > 0) + (last > 0)) + 1
    allowed = heights.growth or LARGEST
    count = least
    while layer_steps(np.empty(count), length, first, last, heights.constant) > allowed * (1 + 1e-9):
        count = max(count + 1, int(1.02 * count))
        if count > 100_000:
            problem = f"cells growing by {allowed:g} do not fill {length:.3g}"
            raise InputError(problem, "allow more", parameter="growth")
    return count


def edge_in_layers(edge: Floats, count: int, first: float, last: float, heights: Heights) -> Floats:
    """Return `count` new nodes (count, 2) on an open edge (n, 2), with cells that grow from its ends.

    `first` and `last` are the lengths of the first and of the last cell; 0: the length is not prescribed.
    """
    curve = Curve(edge)
    nodes = curve.at(arcs_in_layers(curve, count, first, last, heights)[0])
    nodes[0], nodes[-1] = edge[0], edge[-1]
    return nodes


def arcs_in_layers(
    curve: Curve, count: int, first: float, last: float, heights: Heights
) -> tuple[Floats, float]:
    """Return arc lengths (count,) of nodes along a curve, and the largest ratio of neighbouring cells.

    `first` and `last` are the lengths of the cells at the ends of the curve; 0: not prescribed.
    """
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
    """Return the arc length from the end at `origin` to the point at the given distance from it."""
    sign = 1.0 if origin == 0.0 else -1.0
    home = curve.points[0 if origin == 0.0 else -1]
    arc = distance
    for _ in range(30):
        reached = float(np.hypot(*(curve.at(np.array([origin + sign * arc]))[0] - home)))
        if abs(reached / distance - 1.0) < 1e-14:
            break
        arc *= distance / reached
    return arc
