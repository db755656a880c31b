"""The six families of shapes of the paper (Xiao et al., arXiv 2501.11937), each with one parameter.

A new family is a function and a row in `FAMILIES`; corners of the shapes lie on nodes.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.far_field import far_circle, straight
from meshonet.geometry.spacing.along_curve import on_corners

Corners = list[tuple[float, float]]


@dataclass(frozen=True)
class Family:
    """A family of shapes with one parameter, whose values are drawn from `low` to `high` by default."""

    name: str
    parameter: str  # meaning of the parameter, with its unit
    low: float
    high: float
    least: float
    most: float  # smallest and largest value of the parameter for which the shape exists
    topology: Topology
    make: Callable[[float, int, int], Boundary]  # function from the parameter, ni and nj to the boundary
    to_low: bool = False  # whether extrapolation tests low values of the parameter instead of high values

    def boundary(self, parameter: float, ni: int, nj: int) -> Boundary:
        """Return the boundary of the member with the given `parameter`, with ni x nj nodes.

        Raises InputError: a parameter out of range, or too few nodes for the corners.
        """
        if not self.least <= parameter <= self.most:
            what = f"{self.name} with {self.parameter} {parameter:g}"
            raise InputError(what, f"use {self.least:g} to {self.most:g}")
        return self.make(parameter, ni, nj)


def family(name: str) -> Family:
    """Return the family called `name`; raise InputError if there is none.

    >>> family("arch").boundary(0.25, 41, 21).north[20].tolist()
    [0.5, 1.25]
    """
    if name not in FAMILIES:
        raise InputError(f"family {name!r} is not known", "use one of " + ", ".join(FAMILIES))
    return FAMILIES[name]


def polyline(corners: Corners, n: int, like: Corners | None = None) -> Floats:
    """Return `n` nodes (n, 2) along a polyline, in nearly equal steps; every corner is exactly a node.

    Given `like`, the corners of another polyline, each corner has the node index of its counterpart there.

    >>> polyline([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], 5).tolist()
    [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0], [1.0, 0.5], [1.0, 1.0]]
    """
    points = np.array(corners, dtype=np.float64)
    pieces = np.diff(points if like is None else np.array(like), axis=0)
    knots = np.concatenate([[0.0], np.cumsum(np.hypot(*pieces.T))])
    s = on_corners(np.linspace(0.0, knots[-1], n), knots[1:-1])
    nodes = np.stack([np.interp(s, knots, points[:, 0]), np.interp(s, knots, points[:, 1])], axis=1)
    nodes[np.searchsorted(s, knots)] = points
    return nodes


def arch(height: float, ni: int, nj: int) -> Boundary:
    """Return a unit square whose top is y = 1 + `height` sin(pi x)."""
    x = np.linspace(0.0, 1.0, ni)
    top = np.stack([x, 1.0 + height * sin(np.pi * x)], axis=1)
    top[-1] = 1.0, 1.0
    return _upright(polyline([(0.0, 0.0), (1.0, 0.0)], ni), top, nj, f"arch-{height:.6g}")


def hexagon(angle: float, ni: int, nj: int) -> Boundary:
    """Return a unit square whose top and bottom have a kink.

    The kinks, of interior angle `angle` (degrees), are at (1/2, 1 + h) and (1/2, -h), h = 1/(2 tan(angle/2)).
    """
    h = 0.5 / math.tan(math.radians(0.5 * angle))
    south = polyline([(0.0, 0.0), (0.5, -h), (1.0, 0.0)], ni)
    north = polyline([(0.0, 1.0), (0.5, 1.0 + h), (1.0, 1.0)], ni)
    return _upright(south, north, nj, f"hexagon-{angle:.6g}")


def wrench(opening: float, ni: int, nj: int) -> Boundary:
    """Return a unit square with a notch in its top, like the jaw of a wrench.

    The notch, `opening` wide, is centred at x = 1/2 and reaches from y = 1 down to 0.6. The top has a tip at
    y = 1.15 on each side of the notch, 0.05 away from it. Elliptic grids fold at the lower corners of the
    notch. The indices of nodes at corners do not depend on `opening`.
    """
    south, north = polyline([(0.0, 0.0), (1.0, 0.0)], ni), polyline(_jaw(opening), ni, like=_jaw(0.3))
    return _upright(south, north, nj, f"wrench-{opening:.6g}")


def _jaw(opening: float) -> Corners:
    a, b = 0.5 - 0.5 * opening, 0.5 + 0.5 * opening
    return [
        (0.0, 1.0), (a - 0.05, 1.15), (a, 1.0), (a, 0.6), (b, 0.6), (b, 1.0), (b + 0.05, 1.15), (1.0, 1.0),
    ]  # fmt: skip


def semicircle(centre: float, ni: int, nj: int) -> Boundary:
    """Return a 2 by 1 channel, with a semicircle of radius 0.2 on its floor at x = `centre`."""
    radius, length = 0.2, 2.0
    first, arc = centre - radius, np.pi * radius
    whole = length - 2 * radius + arc
    s = on_corners(np.linspace(0.0, whole, ni), np.array([first, first + arc]))
    angle = np.clip((s - first) / radius, 0.0, np.pi)
    behind = s >= first + arc
    x = np.where(s <= first, s, np.where(behind, s - whole + length, centre - radius * cos(angle)))
    y = np.where((s > first) & (s < first + arc), radius * sin(angle), 0.0)
    south = np.stack([x, y], axis=1)
    south[0], south[-1] = (0.0, 0.0), (length, 0.0)
    return _upright(south, polyline([(0.0, 1.0), (length, 1.0)], ni), nj, f"semicircle-{centre:.6g}")


def airfoil(ratio: float, ni: int, nj: int) -> Boundary:
    """Return a closed NACA 00xx airfoil of chord 1 and thickness `ratio` in a circle of radius 15."""
    # imported here since the other families do not need them
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
    from meshonet.geometry.shapes.airfoil.naca import POINTS, thickness
    from meshonet.geometry.spacing.sampling import Sampling

    x = 0.5 - 0.5 * cos(np.linspace(0.0, np.pi, POINTS))
    half = thickness(x, ratio, sharp=True)
    upper, lower = np.stack([x, half], axis=1), np.stack([x, -half], axis=1)
    section = Airfoil(np.concatenate([upper[::-1], lower[1:]]), f"airfoil-{ratio:.6g}")
    return section.boundary(Sampling(ni=ni, nj=nj))


def hole(height: float, ni: int, nj: int) -> Boundary:
    """Return a square of side 2 at (0, 0) with a hole of radius 0.35 at (0, `height`).

    Nodes run clockwise from the rightmost point of the hole.
    """
    ring = far_circle(np.array([0.0, height]), 0.35, ni, 0.0)
    plate = polyline([(1.0, height), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, height)], ni)
    cut = straight(ring[0], plate[0], nj)
    return Boundary(ring, plate, cut, cut, topology="o", name=f"hole-{height:.6g}")


def _upright(south: Floats, north: Floats, nj: int, name: str) -> Boundary:
    """Return the boundary between a bottom and a top joined by straight vertical sides."""
    west, east = (polyline([tuple(south[k]), tuple(north[k])], nj) for k in (0, -1))
    return Boundary(south, north, west, east, name=name)


_KINKS = "interior angle at the kinks in degrees"
FAMILIES: dict[str, Family] = {
    member.name: member
    for member in (
        Family("arch", "height of the arch", -0.1, 0.4, -0.7, 2.0, "quad", arch),
        Family("hexagon", _KINKS, 90.0, 150.0, 45.0, 260.0, "quad", hexagon, to_low=True),
        Family("wrench", "width of the notch", 0.15, 0.45, 0.02, 0.85, "quad", wrench, to_low=True),
        Family("semicircle", "x coordinate of the centre", 0.7, 1.3, 0.25, 1.75, "quad", semicircle),
        Family("airfoil", "thickness in chords", 0.06, 0.24, 0.01, 0.6, "o", airfoil),
        Family("hole", "y coordinate of the centre", -0.4, 0.4, -0.6, 0.6, "o", hole),
    )
}
