"""Boundaries around a closed wall."""

from __future__ import annotations

import math

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.conformal.lift import lift_body, mirrored
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError


def far_circle(centre: Floats, radius: float, n: int, start: float) -> Floats:
    """Return n nodes (n, 2) clockwise on a circle from `start` (radians), the first repeated bitwise."""
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


TURNED = math.radians(10.0)
"""A turn of the far field's start that is worth a note."""


def _start(wall: Floats, centre: Floats) -> tuple[float, tuple[str, ...]]:
    """Return the angle (radians) of the first far-field node around a wall (ni, 2), and a note of it."""
    behind = _direction(wall, centre)
    try:
        lift, w, _ = lift_body(mirrored(wall[:-1]))
    except InputError:
        return behind, (
            "the far field begins straight behind the first wall node: there is no conformal map",
        )
    lead = float(np.mean(w.imag - 2.0 * np.pi * np.arange(len(w)) / len(w)))
    start = -(float(np.angle(lift.quarter)) + lift.phase + lead)
    turn = math.remainder(start - behind, 2.0 * math.pi)
    if abs(turn) <= TURNED:
        return start, ()
    return start, (
        f"the far field begins {math.degrees(turn):.1f} degrees from where the first wall node lies",
    )


def _direction(wall: Floats, centre: Floats) -> float:
    """Return the angle (radians) of the first wall node, seen from the centre."""
    return float(np.arctan2(wall[0, 1] - centre[1], wall[0, 0] - centre[0]))


def o_boundary(
    wall: Floats,
    nj: int,
    centre: Floats,
    radius: float,
    curve: Curve | None = None,
    name: str = "",
    chord: float = 0.0,
    turned: bool = True,
    notes: tuple[str, ...] = (),
) -> Boundary:
    """Return the O boundary of a closed wall within a circle.

    Parameters
    ----------
    wall : (ni, 2) clockwise, first node repeated at the end.
    nj : nodes from the wall to the far field.
    centre, radius : of the far field.
    curve : the curve the wall was sampled from.
    name : of the shape.
    chord : its unit for spacings, see `Boundary`.
    turned : whether the far field begins where the map below says, or, for marches that bring their own, in
        the direction of the first node.
    notes : see `Boundary`; a turn of more than `TURNED` is added.

    The far field runs clockwise at equal angles from where `wall[0]` is carried by the body's conformal
    map, which for a symmetric body is straight behind it: a grid in between is then not sheared. West and
    east are the straight cut from there to the wall.
    """
    middle = np.asarray(centre, dtype=np.float64)
    start, more = _start(wall, middle) if turned else (_direction(wall, middle), ())
    north = far_circle(middle, radius, len(wall), start)
    cut = straight(wall[0], north[0], nj)
    return Boundary(
        wall, north, cut, cut, topology="o", name=name, wall=curve, chord=chord, notes=(*notes, *more)
    )
