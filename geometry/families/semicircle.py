"""Case 4 of the paper: a channel with a semicircle on its floor.

::

     ______________________
    |                      |      2 long, 1 high; radius 0.2; the parameter is x of its centre
    |        .-'-.         |
    '-------'     '--------'      both feet of the semicircle lie on nodes
                c
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.edges import polyline
from meshonet.geometry.families.family import Family
from meshonet.geometry.spacing.along_curve import on_corners

RADIUS = 0.2
LENGTH = 2.0


def boundary(centre: float, ni: int, nj: int) -> Boundary:
    """Return the channel whose semicircle stands at x = `centre`."""
    first, arc = centre - RADIUS, np.pi * RADIUS
    whole = LENGTH - 2 * RADIUS + arc
    s = on_corners(np.linspace(0.0, whole, ni), np.array([first, first + arc]))
    angle = np.clip((s - first) / RADIUS, 0.0, np.pi)
    behind = s >= first + arc
    x = np.where(s <= first, s, np.where(behind, s - whole + LENGTH, centre - RADIUS * np.cos(angle)))
    y = np.where((s > first) & (s < first + arc), RADIUS * np.sin(angle), 0.0)
    south = np.stack([x, y], axis=1)
    south[0], south[-1] = (0.0, 0.0), (LENGTH, 0.0)
    north = polyline([(0.0, 1.0), (LENGTH, 1.0)], ni)
    west, east = polyline([(0.0, 0.0), (0.0, 1.0)], nj), polyline([(LENGTH, 0.0), (LENGTH, 1.0)], nj)
    return Boundary(south, north, west, east, name=f"semicircle-{centre:.6g}")


FAMILY = Family("semicircle", "x of the centre", 0.7, 1.3, 0.25, 1.75, "quad", boundary)
