"""Boundaries around a closed wall."""

import cmath
import math

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError


def far_circle(centre: Floats, radius: float, n: int, start: float) -> Floats:
    """Return nodes (n, 2) clockwise on a circle from the angle `start` (radians); both ends are equal."""
    angle = start - np.linspace(0.0, 2 * np.pi, n)
    nodes = centre + radius * np.stack([cos(angle), sin(angle)], axis=1)
    nodes[-1] = nodes[0]
    return np.asarray(nodes)


def straight(a: Floats, b: Floats, n: int) -> Floats:
    """Return `n` equally spaced nodes (n, 2) from `a` (2,) to `b` (2,); the ends are bitwise `a` and `b`."""
    t = np.linspace(0.0, 1.0, n)[:, None]
    nodes = (1 - t) * a + t * b
    nodes[0], nodes[-1] = a, b
    return np.asarray(nodes)


TURNED = 10.0  # turn of the first far-field node, in degrees, from which on a note mentions it


def _start(wall: Floats, behind: float) -> tuple[float, str]:
    """Return the angle of the first far-field node on the conformal map, and a note."""
    from meshonet.geometry.conformal.lift import lift_body, mirrored  # which domains of blocks do not need

    try:
        lift, w, _ = lift_body(mirrored(wall[:-1]))
    except InputError:
        return behind, "the far field begins straight behind the first wall node: there is no conformal map"
    lead = float(np.mean(w.imag - 2.0 * np.pi * np.arange(len(w)) / len(w)))
    start = -(cmath.phase(lift.quarter) + lift.phase + lead)
    turn = math.degrees(math.remainder(start - behind, 2.0 * math.pi))
    note = f"the far field begins {turn:.1f} degrees from where the first wall node lies"
    return start, note if abs(turn) > TURNED else ""


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
    """Return the O boundary of a closed, clockwise `wall` (ni, 2), with equal steps on a circle as far field.

    If `turned`, the first far-field node is the image of `wall[0]` under the conformal map of the body, so
    that the grid is not sheared. Otherwise that node is in the direction of `wall[0]` from the centre, which
    suffices for marching. West and east are the straight cut from `wall[0]` to the far field. `curve` (the
    exact wall), `name`, `chord` and `notes` are stored in the result.
    """
    middle = np.asarray(centre, dtype=np.float64)
    start, note = math.atan2(wall[0, 1] - middle[1], wall[0, 0] - middle[0]), ""
    if turned:
        start, note = _start(wall, start)
    north = far_circle(middle, radius, len(wall), start)
    cut = straight(wall[0], north[0], nj)
    notes = (*notes, note) if note else notes
    return Boundary(wall, north, cut, cut, topology="o", name=name, wall=curve, chord=chord, notes=notes)
