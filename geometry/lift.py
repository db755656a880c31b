"""The conformal lift: from the plane around a body to a periodic strip, and back.

Winslow's equations keep their form under conformal maps, so an O-grid may be made in whatever plane makes
it easiest. Three maps in a row take an airfoil's wall to a curve close to a straight line::

    z  --Joukowski-->  zeta  --corner removal-->  zeta'  --log-->  w = psi + i phi

    z = centre + quarter (zeta + 1/zeta)           opens the slit between the two ends of the body
    ((v-p)/(v-q))^(1/k) = (v'-P)/(v'-Q)            straightens a corner whose exterior angle is k pi
    zeta' = pole + exp(w)                          unrolls the plane around the body

In the strip the wall is near psi = 0, the far field near psi = T, and phi grows by 2 pi once around.
The wall is walked counter-clockwise here: callers mirror the clockwise wall of an O-grid (`mirrored`).

Theodorsen & Garrick, NACA Report 452 (1933); Karman & Trefftz, Z. Flugtech. Motorluftschiff. 9 (1918) 111.
"""

from __future__ import annotations

from cmath import exp
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from geometry.arrays import Complexes, Floats
from geometry.errors import InputError
from geometry.mirror import farthest

SHARP_TURN = np.radians(80.0)  # a first node that turns more than this is a sharp trailing edge
CORNER_TURN = np.radians(
    15.0
)  # a node near the trailing edge that turns more than this is a corner of its base
BASE_REACH = 0.35  # how far from the trailing edge, in chords, a base corner is looked for
SECOND_PRONG = (
    0.25  # q sits this far from the corner p towards the pole: deep enough to act gently, still inside
)

Plane = TypeVar("Plane", complex, Complexes)


@dataclass(frozen=True)
class Corner:
    """One corner removal: p, q before, P, Q after, exterior angle k pi."""

    p: complex
    q: complex
    P: complex
    Q: complex
    k: float

    def remove(self, v: Complexes) -> Complexes:
        """Return v' for v, any shape; v' = v + O(1) far away."""
        with np.errstate(divide="ignore", invalid="ignore"):
            r = _power((v - self.p) / (v - self.q), 1.0 / self.k)
            straight = (self.Q * r - self.P) / (r - 1.0)
        return np.where(v == self.p, self.P, straight)

    def restore(self, v: Plane) -> Plane:
        """Return v for v', the inverse of `remove`."""
        r = ((v - self.P) / (v - self.Q)) ** self.k
        return (self.q * r - self.p) / (r - 1.0)


@dataclass(frozen=True)
class Lift:
    """The composed map of one body: `lift_body` makes it.

    `centre` and `quarter` carry the user's position, rotation and size; `phase` is what puts
    the first wall node at phi = 0.
    """

    centre: complex
    quarter: complex
    corners: tuple[Corner, ...]
    pole: complex
    phase: float

    def to_plane(self, w: Complexes) -> Complexes:
        """Return z for strip points w, any shape."""
        zeta = self.pole + np.exp(w + 1j * self.phase)
        for corner in reversed(self.corners):
            zeta = corner.restore(zeta)
        return self.centre + self.quarter * (zeta + 1.0 / zeta)

    def point(self, w: complex) -> complex:
        """Return z for one strip point: `to_plane` without the cost of an array."""
        zeta = self.pole + exp(w + 1j * self.phase)
        for corner in reversed(self.corners):
            zeta = corner.restore(zeta)
        return self.centre + self.quarter * (zeta + 1.0 / zeta)

    def to_strip(self, z: Complexes) -> Complexes:
        """Return w for points z in walking order around and outside the body; phi is continuous along it."""
        return self._unroll(self._straighten(_joukowski(z, self.centre, self.quarter)))

    def _straighten(self, zeta: Complexes) -> Complexes:
        for corner in self.corners:
            zeta = corner.remove(zeta)
        return zeta

    def _unroll(self, zeta: Complexes) -> Complexes:
        offset = zeta - self.pole
        return np.log(np.abs(offset)) + 1j * (np.unwrap(np.angle(offset)) - self.phase)


def mirrored(nodes: Floats) -> Complexes:
    """Return x - iy of nodes (..., 2): a clockwise walk turned counter-clockwise."""
    points: Complexes = nodes[..., 0] - 1j * nodes[..., 1]
    return points


def lift_body(wall: Complexes, *, swap: bool = False) -> tuple[Lift, Complexes, tuple[int, ...]]:
    """Return the lift of a body, its wall in the strip and its trailing corners.

    Parameters
    ----------
    wall : (n,) nodes counter-clockwise from the trailing edge, first node not repeated.
    swap : remove the second corner of a blunt edge first. The two removals do not commute, so a mirrored
        body is lifted to the mirrored strip when its corners are swapped.

    Returns
    -------
    lift, w, corners : the map; the (n,) wall points psi + i phi, phi from 0 upwards; the nodes that are
        the sharp edge, or the corners of the blunt one.

    Raises
    ------
    InputError
        fewer than 8 nodes, or a wall that does not wind once around the pole.
    """
    if len(wall) < 8:
        raise InputError(f"the wall has {len(wall)} nodes", "the operator needs at least 8: raise --res")
    turn = np.angle((np.roll(wall, -1) - wall) / (wall - np.roll(wall, 1)))
    tail, base = trailing_corners(wall, turn)
    centre, quarter = _slit(wall, tail, base)
    zeta = follow(wall, centre, quarter)
    pole = _centroid(zeta)
    corners: list[Corner] = []
    ends = [(0, 0.5 * (1.0 + turn[0] / np.pi))] if not base else [(i, 1.0 + turn[i] / np.pi) for i in base]
    for i, k in ends[:: -1 if swap else 1] if (base or tail) else []:
        if not removable(k):
            continue
        corner = _corner(complex(zeta[i]), pole, float(k))
        straight = corner.remove(zeta)
        if not np.isfinite(straight).all():
            continue
        corners.append(corner)
        zeta = straight
        pole = _centroid(zeta)
    offset = zeta - pole
    phi = np.unwrap(np.angle(offset))
    closing = np.angle(offset[0] / offset[-1])
    if not 0.9 < (phi[-1] - phi[0] + closing) / (2 * np.pi) < 1.1:
        raise InputError(
            "the wall does not wind once around its middle", "use meshonet solve-pde for this shape"
        )
    lift = Lift(centre, quarter, tuple(corners), pole, float(phi[0]))
    return lift, np.log(np.abs(offset)) + 1j * (phi - phi[0]), (0,) if tail else tuple(base)


def trailing_corners(wall: Complexes, turn: Floats) -> tuple[bool, list[int]]:
    """Return whether node 0 is a sharp edge, and otherwise the corner of the base on each side of it.

    `turn` (n,) is the angle by which the wall turns at each node.
    """
    if turn[0] > SHARP_TURN:
        return True, []
    n, chord = len(wall), np.abs(wall - wall[0]).max()
    edge = np.abs(np.diff(np.append(wall, wall[0])))
    after, before = np.cumsum(edge), np.cumsum(edge[::-1])
    base = []
    for side in (
        1 + np.flatnonzero(after < BASE_REACH * chord),
        n - 1 - np.flatnonzero(before < BASE_REACH * chord),
    ):
        side = side[(side > 0) & (side < n)]
        if side.size and turn[side].max() > CORNER_TURN:
            base.append(int(side[np.argmax(turn[side])]))
    return False, base


def _slit(wall: Complexes, sharp: bool, base: list[int]) -> tuple[complex, complex]:
    """Return the middle and a quarter of the slit that Joukowski's map opens.

    Its ends sit inside the body, off each tip by a(1 - sqrt(1 - r/a)) where r is the tip's radius and a the
    half chord: the foci when the body is an ellipse. A sharp edge is itself an end.
    """
    first, last = farthest(wall)
    nose = complex(0.5 * (wall[first] + wall[last]))
    if sharp:
        tail = complex(wall[0])
    elif len(base) == 2:
        gap = abs(wall[base[0]] - wall[base[1]])
        middle = 0.5 * (wall[base[0]] + wall[base[1]])
        tail = complex(middle + 0.25 * gap * _unit(nose - middle))
    else:
        tail = _focus(wall, 0, nose)
    head = 0.5 * (_focus(wall, first, complex(wall[0])) + _focus(wall, last, complex(wall[0])))
    if abs(tail - head) < 0.2 * abs(nose - wall[0]):  # round bodies: the foci meet, the map must not vanish
        middle = 0.5 * (tail + head)
        spread = 0.1 * (wall[0] - nose)
        tail, head = complex(middle + spread), complex(middle - spread)
    return 0.5 * (tail + head), 0.25 * (tail - head)


def _focus(wall: Complexes, tip: int, other: complex) -> complex:
    """Return the focus behind node `tip`: the circle through it and nodes .004 chord away tells."""
    chord = abs(other - wall[tip])
    a, b, c = (wall[k] for k in beside(wall, tip, other))
    area = 0.5 * abs(((a - b) * np.conj(c - b)).imag)
    radius = abs(a - b) * abs(c - b) * abs(a - c) / (4.0 * area + 1e-12 * chord**2)
    ratio = float(np.clip(2.0 * radius / chord, 4e-4, 0.8))
    inwards = 1j * (a - c)
    if (np.conj(inwards) * (other - b)).real < 0.0:
        inwards = -inwards
    return complex(b + _unit(inwards) * 0.5 * chord * (1.0 - np.sqrt(1.0 - ratio)))


def beside(wall: Complexes, tip: int, other: complex) -> tuple[int, int, int]:
    """Return the nodes ahead of `tip`, at it and behind it, .004 of the chord to `other` away from it."""
    n, chord = len(wall), abs(other - wall[tip])
    far = np.abs(wall - wall[tip]) > 0.004 * chord
    ahead = next((m for m in range(1, n // 2) if far[(tip + m) % n]), 1)
    behind = next((m for m in range(1, n // 2) if far[(tip - m) % n]), 1)
    return (tip + ahead) % n, tip, (tip - behind) % n


def _joukowski(z: Complexes, centre: complex, quarter: complex) -> Complexes:
    """Return the outer root zeta of z = centre + quarter (zeta + 1/zeta); the slit is its only cut."""
    Z = (z - centre) / quarter + 0.0  # a point on the slit is on its upper side
    Z = np.where(np.abs(Z - 2.0) < 1e-13, 2.0, Z)  # an end of the slit is a branch point: no rounding there
    return 0.5 * (Z + np.sqrt(Z - 2.0) * np.sqrt(Z + 2.0))


def follow(wall: Complexes, centre: complex, quarter: complex) -> Complexes:
    """Return zeta along the wall, changing root where a side of a cambered wall crosses the slit."""
    outer = _joukowski(wall, centre, quarter)
    Z = (wall[1:] - centre) / quarter  # from behind the trailing edge, which may be a branch point
    height, along = Z.imag, Z.real
    turns = (height[1:] >= 0.0) != (height[:-1] >= 0.0)
    fall = np.where(turns, height[:-1] - height[1:], 1.0)
    meets = along[:-1] + (along[1:] - along[:-1]) * height[:-1] / fall
    crossed = np.append(False, np.cumsum(turns & (np.abs(meets) < 2.0)) % 2 == 1)
    crossed ^= crossed[np.argmax(np.abs(outer[1:]))]  # the wall is outside where it is farthest from the slit
    zeta = np.append(outer[0], np.where(crossed, 1.0 / outer[1:], outer[1:]))
    near = 0.5 * (zeta[1] + zeta[-1])
    if abs(1.0 / zeta[0] - near) < abs(zeta[0] - near):
        zeta[0] = 1.0 / zeta[0]
    return zeta


def removable(k: float) -> bool:
    """Return whether a corner of exterior angle k pi is one that is straightened."""
    return 0.55 < k < 0.995 or 1.03 < k < 1.9


def _corner(p: complex, pole: complex, k: float) -> Corner:
    q = p + SECOND_PRONG * (pole - p)
    return Corner(p, q, p, p - (p - q) / k, k)


def _centroid(zeta: Complexes) -> complex:
    """Return the centroid of the area inside a closed polygon."""
    base = zeta - zeta[0]  # near the origin, against cancellation
    ahead = np.roll(base, -1)
    cross = (np.conj(base) * ahead).imag
    return complex(zeta[0] + (cross * (base + ahead)).sum() / (3.0 * cross.sum()))


def _power(v: Complexes, exponent: float) -> Complexes:
    """Return v ** exponent; numpy's own takes three times as long."""
    angle = exponent * np.angle(v)
    found = np.empty(np.shape(v), complex)
    found.real, found.imag = np.cos(angle), np.sin(angle)
    found *= np.abs(v) ** exponent
    return found


def _unit(v: complex) -> complex:
    return v / abs(v)
