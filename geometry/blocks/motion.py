"""Rigid motions, of one periodic side to the other or of a wall."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats


@dataclass(frozen=True)
class Motion:
    """Rigid motion x -> `turn` x + `shift`, for example from one side of a periodic pair to the other.

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
        if self.turn:  # written out: the rounding of a matrix product depends on the number of rows
            terms = [np.array(row) * nodes for row in self.turn]
            moved = np.stack([sum(term[..., k] for k in range(term.shape[-1])) for term in terms], axis=-1)
        return np.asarray(moved + np.array(self.shift) if self.shift else moved)

    @property
    def translation(self) -> Floats:
        """The `shift` (2,) or (3,); zeros if there is none."""
        return np.array(self.shift or (0.0,) * (len(self.turn) or 2))

    @property
    def rotation(self) -> tuple[float, Floats]:
        """Angle (radians, counter-clockwise) and centre (2,) of a rotation that equals a motion in the plane.

        A pure translation has the angle 0 and the origin as its centre.
        """
        if not self.turn:
            return 0.0, np.zeros(2)
        from meshonet.geometry.linear import solve  # which few grids need

        turn = np.array(self.turn)
        angle = math.atan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])
        return angle, solve(np.eye(2) - turn, self.translation) if angle else np.zeros(2)

    def alike(self, other: Motion, tolerance: float) -> bool:
        """Return whether two motions are equal to a relative `tolerance`.

        Both must move the origin, and points at distance L on the axes, to the same places within `tolerance`
        times L. L is the largest component of the two shifts, and at least 1 if there is a rotation.
        """
        size = max(1e-300, *map(abs, (*self.shift, *other.shift, float(bool(self.turn or other.turn)))))
        dimension = max(2, *(len(rows) for rows in (self.shift, self.turn, other.shift, other.turn)))
        frame = size * np.concatenate([np.zeros((1, dimension)), np.eye(dimension)])
        return bool(np.abs(self(frame) - other(frame)).max() <= tolerance * size)

    def inverse(self) -> Motion:
        """Return the inverse motion, up to rounding."""
        turn = np.array(self.turn).T
        back = Motion(turn=tuple(map(tuple, turn.tolist())) if self.turn else ())
        shift = back(-np.array(self.shift)) if self.shift else np.empty(0)
        return replace(back, shift=tuple(float(x) + 0.0 for x in shift))
