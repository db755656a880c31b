"""The conformal lift: a map from the plane around a body to a periodic strip, and back.

Winslow's equations are invariant under it. Three maps take the wall of a body nearly to a line::

    z  --Joukowski-->  zeta  --corner removal-->  zeta'  --log-->  w = psi + i phi

    z = centre + quarter (zeta + 1/zeta)           maps a slit between the ends of the body to a circle
    ((v-p)/(v-q))^(1/k) = (v'-P)/(v'-Q)            straightens a corner with exterior angle k pi
    zeta' = pole + exp(w)                          unrolls the plane around the body

The wall is near psi = 0 and runs counter-clockwise (`mirrored`); phi grows by 2 pi once around. The code,
with the choice of slit and corners, is kernels/conformal/lift.c.

Theodorsen & Garrick, NACA Report 452 (1933); Karman & Trefftz, Z. Flugtech. Motorluftschiff. 9 (1918) 111.
"""

from dataclasses import dataclass
from itertools import starmap
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.elementary import functions_of
from meshonet.geometry.errors import InputError
from meshonet.kernels import _native

SECOND_PRONG = 0.25  # as in kernels/conformal/lift.c


@dataclass(frozen=True)
class Corner:
    """The map of Karman and Trefftz that straightens a corner with exterior angle k pi.

    ((v-p)/(v-q))^(1/k) = (v'-P)/(v'-Q) maps v to v', the corner p to P, and a point q inside the body to Q.
    """

    p: Any
    q: Any
    P: Any
    Q: Any
    k: Any

    def restore(self, v: Any) -> Any:
        """Return the points that the map takes to `v`, an array or a torch tensor."""
        r = ((v - self.P) / (v - self.Q)) ** self.k
        return (self.q * r - self.p) / (r - 1.0)


@dataclass(frozen=True)
class Lift:
    """The conformal map from the plane z around a body to a strip w = psi + i phi of period 2 pi.

    First, z = centre + quarter (zeta + 1/zeta), solved for zeta, maps a slit in the body to a circle.
    `centre` is the middle of the slit, and `quarter` a quarter of the vector from end to end of the slit.
    Then the maps `corners` straighten corners; `pole` is the centroid of the resulting wall. Last, w is the
    logarithm of the mapped point minus `pole`. `phase` is subtracted from phi, so that the first wall node is
    at 0. Attributes may be torch tensors.
    """

    centre: Any
    quarter: Any
    corners: tuple[Corner, ...]
    pole: Any
    phase: Any

    def to_plane(self, w: Any, xp: Any = np) -> Any:
        """Return the points z that are mapped to `w` (an array of any shape); `xp` is numpy or torch."""
        zeta = self.pole + functions_of(xp).exp(w + 1j * self.phase)
        for corner in reversed(self.corners):
            zeta = corner.restore(zeta)
        return self.centre + self.quarter * (zeta + 1.0 / zeta)

    def to_strip(self, z: Complexes) -> Complexes:
        """Return w (n,) of points `z` (n,) in order around the body; Im w is continuous along them."""
        return _native.lift_to_strip(self, np.ascontiguousarray(z, complex))


def mirrored(nodes: Floats) -> Complexes:
    """Return x - iy of nodes (..., 2): the mirror image, counter-clockwise for a clockwise curve."""
    points: Complexes = nodes[..., 0] - 1j * nodes[..., 1]
    return points


def lift_body(wall: Complexes, *, swap: bool = False) -> tuple[Lift, Complexes, tuple[int, ...]]:
    """Return the conformal map around a body, the mapped wall (n,), and the indices of the body's corners.

    `wall` (n,) runs counter-clockwise from the trailing edge, without its repeated first node. The corners of
    a blunt trailing edge are straightened one after another; `swap` reverses this order. Two bodies that are
    mirror images have mirrored results if `swap` is set for one of them. Raises InputError: fewer than 8
    nodes; a wall that does not wind once around its middle.
    """
    if len(wall) < 8:
        raise InputError(f"the wall has {len(wall)} nodes", "use at least 8")
    ring = np.ascontiguousarray(wall, complex)
    centre, quarter, removed, pole, phase, w, corners, winding = _native.lift_body(ring, swap)
    if not 0.9 < winding < 1.1:
        remedy = "use a method without a conformal map for this shape"
        raise InputError("the wall does not wind once around its middle", remedy)
    return Lift(centre, quarter, tuple(starmap(Corner, removed)), pole, phase), w, corners


def follow(wall: Complexes, centre: complex, quarter: complex) -> Complexes:
    """Return zeta (n,), continuous along `wall` (n,), that solves wall = centre + quarter (zeta + 1/zeta)."""
    return _native.lift_follow(np.ascontiguousarray(wall, complex), centre, quarter)


def removable(k: float) -> bool:
    """Return whether a map of the class `Corner` can straighten a corner with exterior angle k pi."""
    return 0.55 < k < 0.995 or 1.03 < k < 1.9
