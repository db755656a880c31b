"""Case 1 of the paper: a unit square under an arch.

::

         .-'''-.        top: y = 1 + h sin(pi x), h the height of the arch
       .'       '.
      |           |     nodes at equal steps of x on top and bottom
      |           |
      '-----------'
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.edges import polyline
from meshonet.geometry.families.family import Family


def boundary(height: float, ni: int, nj: int) -> Boundary:
    """Return the square under an arch of `height` (sides of the square; negative hangs down)."""
    x = np.linspace(0.0, 1.0, ni)
    top = np.stack([x, 1.0 + height * np.sin(np.pi * x)], axis=1)
    top[-1] = 1.0, 1.0
    south = polyline([(0.0, 0.0), (1.0, 0.0)], ni)
    west, east = polyline([(0.0, 0.0), (0.0, 1.0)], nj), polyline([(1.0, 0.0), (1.0, 1.0)], nj)
    return Boundary(south, top, west, east, name=f"arch-{height:.6g}")


FAMILY = Family("arch", "height of the arch", -0.1, 0.4, -0.7, 2.0, "quad", boundary)
