"""The conformal lift: a conformal map from the plane around a body to a periodic strip, and back.

Winslow's equations are invariant under conformal maps, so an O grid may be generated in whatever plane makes
it easiest. Three successive maps take the wall of an airfoil to a curve close to a straight line::

    z  --Joukowski-->  zeta  --corner removal-->  zeta'  --log-->  w = psi + i phi

    z = centre + quarter (zeta + 1/zeta)           maps a slit between the two ends of the body to a circle
    ((v-p)/(v-q))^(1/k) = (v'-P)/(v'-Q)            straightens a corner with exterior angle k pi
    zeta' = pole + exp(w)                          unrolls the plane around the body

In the strip the wall is near psi = 0, the far field near psi = T, and phi grows by 2 pi once around. Here the
wall runs counter-clockwise: callers mirror the clockwise wall of an O grid (`mirrored`).

A first node at which the wall turns by more than 80 degrees is a sharp trailing edge, and an end of the slit.
On other walls the corners of a blunt base are sought: the nodes within 0.35 chords of the first that turn
most, by more than 15 degrees; the slit ends behind the base. Without corners it ends a(1 - sqrt(1 - r/a))
inside each tip, with r the tip radius and a the half chord: at the foci of an ellipse. The code is
kernels/conformal/lift.c.

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
    """The map of Karman and Trefftz that straightens one corner, whose exterior angle is k pi.

    It maps v to v' by ((v-p)/(v-q))^(1/k) = (v'-P)/(v'-Q), and therefore the points p and q to P and Q. All
    attributes are numbers or torch tensors.
    """

    p: Any
    q: Any
    P: Any
    Q: Any
    k: Any

    def restore(self, v: Any) -> Any:
        """Return v for v', a NumPy array or a torch tensor."""
        r = ((v - self.P) / (v - self.Q)) ** self.k
        return (self.q * r - self.p) / (r - 1.0)


@dataclass(frozen=True)
class Lift:
    """The conformal map between the plane z around one body and a strip w = psi + i phi.

    It is made by `lift_body`. The wall is near psi = 0, and phi grows by 2 pi once around the body.

    `centre` and `quarter` hold the position, rotation and size of the body; `phase` puts the first wall node
    at phi = 0. All are numbers or torch tensors.
    """

    centre: Any
    quarter: Any
    corners: tuple[Corner, ...]
    pole: Any
    phase: Any

    def to_plane(self, w: Any, xp: Any = np) -> Any:
        """Return the points z of strip points w of any shape; `xp` is their module, numpy or torch."""
        zeta = self.pole + functions_of(xp).exp(w + 1j * self.phase)
        for corner in reversed(self.corners):
            zeta = corner.restore(zeta)
        return self.centre + self.quarter * (zeta + 1.0 / zeta)

    def to_strip(self, z: Complexes) -> Complexes:
        """Return the strip points w (n,) of points z (n,) that lie outside the body, in order around it.

        The imaginary part phi of w is continuous from each point to the next.
        """
        return _native.lift_to_strip(self, np.ascontiguousarray(z, complex))


def mirrored(nodes: Floats) -> Complexes:
    """Return x - iy of nodes (..., 2): the mirror image, which turns a clockwise curve counter-clockwise."""
    points: Complexes = nodes[..., 0] - 1j * nodes[..., 1]
    return points


def lift_body(wall: Complexes, *, swap: bool = False) -> tuple[Lift, Complexes, tuple[int, ...]]:
    """Return the lift of a body, its wall (n,) in the strip, and the indices of its trailing corners.

    `wall` (n,) runs counter-clockwise from the trailing edge and does not repeat its first node; the
    imaginary part phi of the strip coordinate rises from 0 along it. With `swap`, the second corner of a
    blunt edge is removed before the first. The two removals do not commute: only with swapped corners is the
    strip of a mirrored body the mirrored strip.

    Raises InputError: fewer than 8 nodes, or a wall that does not wind once around the pole.
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
    """Return zeta (n,) of the nodes of a `wall` (n,), where z = centre + quarter (zeta + 1/zeta).

    zeta is continuous along the wall: where a cambered wall crosses the slit that this map opens to a circle,
    the other root of the equation is taken.
    """
    return _native.lift_follow(np.ascontiguousarray(wall, complex), centre, quarter)


def removable(k: float) -> bool:
    """Return whether the map can straighten a corner with exterior angle k pi."""
    return 0.55 < k < 0.995 or 1.03 < k < 1.9
