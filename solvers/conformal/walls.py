"""The two walls of an O grid in the periodic strip, and whether the strip resolves them."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.conformal.lift import Lift, lift_body, mirrored
from meshonet.geometry.elementary import modulus
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.polygon.mirror import Axis, handedness
from meshonet.solvers.conformal.strip import MODES

SHARPEST = {"wall": 0.017, "far field": 1e-3}  # sum (radians) of modes beyond MODES / 2 of a resolved wall
ROUGHEST = 0.1  # the same of an airfoil that may be tried: its spacing is uneven, not its shape
SHARP_TURN = np.radians(25.0)  # of an unevenly spaced wall, from which the line there halves the angle
CORNER = np.radians(85.0)  # turn at a node, trailing edge aside, that makes a body no airfoil


class StripWalls(NamedTuple):
    """The wall of a body and the far field, mapped conformally to a strip, with n = ni - 1 nodes each."""

    lift: Lift  # maps the strip to the plane
    wall: Complexes  # (n,) F = w - i theta, periodic in theta, at the nodes of the wall
    far: Complexes  # (n,) the same at the nodes of the far field
    z: Complexes  # (n,) nodes of the wall in the plane
    corners: tuple[int, ...]  # trailing corners
    axis: Axis | None  # mirror axis of a symmetric boundary
    hand: int  # tells others from their mirror images
    rough: bool = False  # whether uneven spacing slightly exceeds the resolution of the strip (`is_rough`)


def walls(boundary: Boundary) -> StripWalls:
    """Map wall and far field of an O boundary to a strip. Raises InputError if there is no conformal map."""
    z, far = mirrored(boundary.south[:-1]), mirrored(boundary.north[:-1])
    hand, (point, direction) = handedness(z, far)
    # near the origin: far from it the map's branch points are subject to cancellation
    lift, w, corners = lift_body(z - z[0], swap=hand < 0)
    theta = 2.0 * np.pi * np.arange(len(z)) / len(z)
    away = lift.to_strip(far - z[0])
    lift = replace(lift, centre=lift.centre + z[0])
    away -= 2j * np.pi * np.round((away.imag - w.imag).mean() / (2.0 * np.pi))
    axis = None if hand else (point.conjugate(), direction.conjugate())
    return StripWalls(lift, w - 1j * theta, away - 1j * theta, z, corners, axis, hand)


def is_rough(body: StripWalls) -> bool:
    """Return whether wall nodes are spaced slightly too unevenly for the Fourier modes: cells may fold.

    Let s be the sum of the amplitudes (radians) of the highest Fourier modes of wall or far field in a strip,
    the conformal image of the domain. False if s is at most `SHARPEST` for both. True if it is larger at the
    wall of an airfoil only, and below `ROUGHEST`. Raises InputError otherwise.
    """
    n = len(body.wall)
    k = np.minimum(np.arange(n), n - np.arange(n))
    rough = False
    for name, F in (("wall", body.wall), ("far field", body.far)):
        sharp = float(modulus(np.fft.fft(F))[(k > MODES // 2) & (k <= MODES)].sum() / n)
        if sharp > SHARPEST[name]:
            rough = name == "wall" and sharp < ROUGHEST and bool(body.corners) and not _has_other_corner(body)
            if not rough:
                raise InputError(f"its {name} has corners or spacing that the strip does not resolve")
    return rough


def sharp_turns(body: StripWalls) -> tuple[int, ...]:
    """Return the node indices of trailing-edge corners, then of other sharp turns of the wall."""
    others = set(np.flatnonzero(_turn(body) > SHARP_TURN).tolist()) - set(body.corners)
    return (*body.corners, *sorted(others))


def _has_other_corner(body: StripWalls) -> bool:
    turn = np.abs(_turn(body))
    turn[list(body.corners)] = 0.0
    return bool(turn.max() > CORNER)


def _turn(body: StripWalls) -> Floats:
    """Return the angle (n,) by which the wall turns at every node."""
    return turning(np.stack([body.z.real, body.z.imag], axis=1), closed=True)
