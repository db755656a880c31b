"""A rigid motion as axis, centre, angle and shift, as flow solvers describe periodic sides."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.elementary import product
from meshonet.geometry.linear import solve

_NEARLY_HALF = 3.1
"""Angle in radians above which the antisymmetric part of a rotation matrix is too small to give the axis."""


class Screw(NamedTuple):
    """A rotation by `angle` radians about the unit `axis` (3,) through `centre` (3,), then a `shift` (3,).

    With a rotation, the shift is along the axis, and the centre is the point of the axis nearest to the
    origin. Without a rotation, the angle is 0, the axis is z and the centre is the origin. `angles` (3,) are
    the angles of three successive rotations, about x, y and z, that give the same rotation.
    """

    angle: float
    axis: Floats
    centre: Floats
    shift: Floats
    angles: Floats


SAME_PERIOD = 1e-9
"""Relative difference that counts as rounding: of two motions, or of a whole turn and a number of periods."""


def period_of(motion: Motion) -> tuple[Screw, float]:
    """Return a motion as a screw, and how many such motions make a whole turn (0 for a translation)."""
    screw = screw_of(motion)
    if not screw.angle:
        return screw, 0.0
    turn = 2.0 * math.pi / abs(screw.angle)
    if abs(turn - round(turn)) > SAME_PERIOD * turn:
        return screw, turn
    return screw._replace(angle=math.copysign(2.0 * math.pi / round(turn), screw.angle)), float(round(turn))


def by_period(connections: Sequence[Connection]) -> list[tuple[Motion, list[Connection]]]:
    """Return the different motions of periodic connections, each with the connections that have it.

    Connections that have the inverse motion are reversed.
    """
    periods: list[tuple[Motion, list[Connection]]] = []
    for each in connections:
        if each.transform is None:
            continue
        ways = [(way, way.transform or Motion()) for way in (each, each.reversed())]
        pairs = ((way, turn, *period) for period in periods for way, turn in ways)
        known = ((way, own) for way, turn, motion, own in pairs if motion.alike(turn, SAME_PERIOD))
        way, own = next(known, (each, None))
        if own is None:
            periods.append((each.transform, [each]))
        else:
            own.append(way)
    return periods


def screw_of(motion: Motion) -> Screw:
    """Return a motion of the plane z = 0 or of space as a screw (Chasles' theorem).

    The component of the axis that is largest in magnitude is positive; the angle may be negative. The axis is
    computed from the antisymmetric part of the rotation R; at half a turn it is the longest column of R + 1.
    """
    turn, shift = np.eye(3), np.zeros(3)
    shift[: len(motion.shift)] = motion.shift
    if motion.turn:
        turn[: len(motion.turn), : len(motion.turn)] = motion.turn
    angles = np.array(
        [math.atan2(turn[2, 1], turn[2, 2]), -math.asin(min(max(turn[2, 0], -1.0), 1.0)),
         math.atan2(turn[1, 0], turn[0, 0])]
    )  # fmt: skip
    if len(motion.turn) < 3:
        angle, centre = motion.rotation
        rest = np.zeros(3) if angle else shift
        return Screw(angle, np.array([0.0, 0.0, 1.0]), np.append(centre, 0.0), rest, angles)
    twice = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    angle = math.atan2(math.hypot(*twice), np.trace(turn) - 1.0)
    if not angle:
        return Screw(0.0, np.array([0.0, 0.0, 1.0]), np.zeros(3), shift, angles)
    axis = twice
    if angle > _NEARLY_HALF:
        columns = turn + np.eye(3)
        axis = columns[:, np.argmax((columns**2).sum(axis=0))]
        axis = -axis if product(axis, twice) < 0 else axis
    largest = axis[np.argmax(np.abs(axis))]
    axis, angle = axis / math.copysign(math.hypot(*axis), largest), math.copysign(angle, largest)
    along = product(shift, axis) * axis
    centre = solve(np.eye(3) - turn + np.outer(axis, axis), shift - along)
    return Screw(angle, axis, centre, along, angles)
