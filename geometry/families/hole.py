r"""Case 6 of the paper: a plate with a round hole that moves up and down.

::

     ____________       2 by 2 around (0, 0); radius 0.35; the parameter is y of the hole's centre
    |     __     |
    |    /  \    |      clockwise from the hole's rightmost place; the plate's corners lie on nodes
    |    \__/    |
    |            |
    '------------'
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.edges import polyline
from meshonet.geometry.families.family import Family
from meshonet.geometry.shapes.far_field import far_circle, straight

RADIUS = 0.35


def boundary(height: float, ni: int, nj: int) -> Boundary:
    """Return the plate whose hole is centred at y = `height`."""
    hole = far_circle(np.array([0.0, height]), RADIUS, ni, 0.0)
    plate = polyline([(1.0, height), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, height)], ni)
    cut = straight(hole[0], plate[0], nj)
    return Boundary(hole, plate, cut, cut, topology="o", name=f"hole-{height:.6g}")


FAMILY = Family("hole", "y of the centre", -0.4, 0.4, -0.6, 0.6, "o", boundary)
