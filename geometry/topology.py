"""Boundaries around a closed wall."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Floats
from geometry.boundary import Boundary
from geometry.curves import Curve


def far_circle(centre: Floats, radius: float, n: int, start: float) -> Floats:
    """Return n nodes (n, 2) clockwise on a circle at equal angles from `start` (radians), the first repeated bitwise."""
    angle = start - np.linspace(0.0, 2 * np.pi, n)
    nodes = centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    nodes[-1] = nodes[0]
    return np.asarray(nodes)


def straight(a: Floats, b: Floats, n: int) -> Floats:
    """Return n nodes (n, 2) in equal steps from a (2,) to b (2,), both ends bitwise."""
    t = np.linspace(0.0, 1.0, n)[:, None]
    nodes = (1 - t) * a + t * b
    nodes[0], nodes[-1] = a, b
    return np.asarray(nodes)


def o_boundary(
    wall: Floats, nj: int, centre: Floats, radius: float, curve: Curve | None = None, name: str = ""
) -> Boundary:
    """Return the O boundary of a closed wall within a circle.

    Parameters
    ----------
    wall : (ni, 2) clockwise, first node repeated at the end.
    nj : nodes from the wall to the far field.
    centre, radius : of the far field.
    curve : the curve the wall was sampled from.
    name : of the shape.

    The far field runs clockwise at equal angles from the direction of `wall[0]`; west and east are the
    straight cut from there to the wall.
    """
    out = wall[0] - centre
    north = far_circle(
        np.asarray(centre, dtype=np.float64), radius, len(wall), float(np.arctan2(out[1], out[0]))
    )
    cut = straight(wall[0], north[0], nj)
    return Boundary(wall, north, cut, cut, topology="o", name=name, wall=curve)
