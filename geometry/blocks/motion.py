"""Rigid motions, of one periodic side to the other or of a wall, and as screws for flow solvers."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import product
from meshonet.geometry.linear import solve


@dataclass(frozen=True)
class Motion:
    """Rigid motion x -> `turn` x + `shift`, for example from one of two periodic sides to the other.

    Parameters
    ----------
    shift : tuple of float, optional
        Translation along each coordinate; empty: no translation.
    turn : tuple of tuple of float, optional
        Rows of the rotation matrix; empty: no rotation.
    """

    shift: tuple[float, ...] = ()
    turn: tuple[tuple[float, ...], ...] = ()

    def __call__(self, nodes: Floats) -> Floats:
        """Return `nodes` (..., d) moved; the result for a node is bitwise the same alone or among others."""
        moved = nodes
        if self.turn:  # written out: what a matrix product rounds to depends on the count of rows
            terms = [np.array(row) * nodes for row in self.turn]
            moved = np.stack([sum(term[..., k] for k in range(term.shape[-1])) for term in terms], axis=-1)
        return np.asarray(moved + np.array(self.shift) if self.shift else moved)

    @property
    def translation(self) -> Floats:
        """The shift (2 or 3,), zero where there is none."""
        return np.array(self.shift or (0.0,) * (len(self.turn) or 2))

    @property
    def rotation(self) -> tuple[float, Floats]:
        """Angle in radians, counter-clockwise, and centre (2,) of a motion in the plane.

        Without a rotation the angle is 0 and the centre is the origin: the motion is its shift.
        """
        if not self.turn:
            return 0.0, np.zeros(2)
        from meshonet.geometry.linear import solve  # which few grids need

        turn = np.array(self.turn)
        angle = math.atan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])
        return angle, solve(np.eye(2) - turn, self.translation) if angle else np.zeros(2)

    def alike(self, other: Motion, tolerance: float) -> bool:
        """Return whether two motions are equal to a relative `tolerance`.

        Both motions are applied to the origin and to a point on each axis, at a distance L from the origin.
        The results may differ by `tolerance` times L. L is the largest component of the shifts, and at least
        1 if there is a rotation.
        """
        size = max(1e-300, *map(abs, (*self.shift, *other.shift, float(bool(self.turn or other.turn)))))
        dimension = max(2, *(len(rows) for rows in (self.shift, self.turn, other.shift, other.turn)))
        frame = size * np.concatenate([np.zeros((1, dimension)), np.eye(dimension)])
        return bool(np.abs(self(frame) - other(frame)).max() <= tolerance * size)

    def inverse(self) -> Motion:
        """Return the inverse motion, to rounding."""
        turn = np.array(self.turn).T
        back = Motion(turn=tuple(map(tuple, turn.tolist())) if self.turn else ())
        shift = back(-np.array(self.shift)) if self.shift else np.empty(0)
        return replace(back, shift=tuple(float(x) + 0.0 for x in shift))


_NEARLY_HALF = 3.1
"""Angle in radians above which the antisymmetric part of a rotation matrix is too small to give the axis."""


class Screw(NamedTuple):
    """A rotation by `angle` radians about the unit `axis` (3,) through `centre` (3,), then a `shift` (3,).

    If there is a rotation, the shift is along the axis, and the centre is the point of the axis nearest to
    the origin. If there is none, the angle is 0, the axis z and the centre the origin. `angles` (3,) are the
    angles of successive rotations about x, y and z that give the same rotation.
    """

    angle: float
    axis: Floats
    centre: Floats
    shift: Floats
    angles: Floats


def screw_of(motion: Motion) -> Screw:
    """Return a motion of the plane z = 0 or of space as a screw (Chasles' theorem).

    The largest coordinate of the axis is positive; the angle may be negative. The axis comes from the
    antisymmetric part of the rotation R; at half a turn it is the longest column of R + 1.
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
