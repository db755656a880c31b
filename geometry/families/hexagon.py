"""Case 2 of the paper: a hexagon whose top and bottom are kinked, both by the same angle.

::

          .^.           the angle is that inside the kinks at (1/2, 1 + h) and (1/2, -h): 90 degrees
        .'   '.         where h = 1/2, 180 where it is a square, more where the kinks point inwards
       |       |
        '.   .'         both kinks lie on nodes
          'v'
"""

from __future__ import annotations

import math

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.edges import polyline
from meshonet.geometry.families.family import Family


def boundary(angle: float, ni: int, nj: int) -> Boundary:
    """Return the hexagon with kinks of `angle` degrees."""
    h = 0.5 / math.tan(math.radians(0.5 * angle))
    south = polyline([(0.0, 0.0), (0.5, -h), (1.0, 0.0)], ni)
    north = polyline([(0.0, 1.0), (0.5, 1.0 + h), (1.0, 1.0)], ni)
    west, east = polyline([(0.0, 0.0), (0.0, 1.0)], nj), polyline([(1.0, 0.0), (1.0, 1.0)], nj)
    return Boundary(south, north, west, east, name=f"hexagon-{angle:.6g}")


_ANGLE = "angle of the kinks in degrees"
FAMILY = Family("hexagon", _ANGLE, 90.0, 150.0, 45.0, 260.0, "quad", boundary, to_low=True)
