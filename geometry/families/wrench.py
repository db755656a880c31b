"""Case 3 of the paper: a wrench, a unit square with a jaw in its top.

::

         .          .         the opening w is the width of the jaw, centred at x = 1/2, from y = 1 to 0.6;
       .' |        | '.       its lips stand 0.05 outside it at y = 1.15
     .'   |   w    |   '.
    |     |________|     |    all eight kinks of the top lie on nodes; those at the bottom of the jaw turn by
    |                    |    270 degrees inside the domain, where elliptic grids fold
    '--------------------'

The kinks lie on the same nodes whatever the opening, so that the nodes of the boundary move smoothly with it:
what is learnt from some openings then holds for those between.
"""

from __future__ import annotations

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.edges import Corners, polyline
from meshonet.geometry.families.family import Family

MIDDLE = 0.3
"""Opening whose steps along the top are nearly equal; others have its kinks' nodes."""


def boundary(opening: float, ni: int, nj: int) -> Boundary:
    """Return the wrench whose jaw is `opening` wide (sides of the square)."""
    south = polyline([(0.0, 0.0), (1.0, 0.0)], ni)
    north = polyline(_top(opening), ni, like=_top(MIDDLE))
    west, east = polyline([(0.0, 0.0), (0.0, 1.0)], nj), polyline([(1.0, 0.0), (1.0, 1.0)], nj)
    return Boundary(south, north, west, east, name=f"wrench-{opening:.6g}")


def _top(opening: float) -> Corners:
    a, b = 0.5 - 0.5 * opening, 0.5 + 0.5 * opening
    return [
        (0.0, 1.0), (a - 0.05, 1.15), (a, 1.0), (a, 0.6), (b, 0.6), (b, 1.0), (b + 0.05, 1.15), (1.0, 1.0),
    ]  # fmt: skip


FAMILY = Family("wrench", "opening of the jaw", 0.15, 0.45, 0.02, 0.85, "quad", boundary, to_low=True)
