"""O grids as strips: the logarithm around the middle of the body, where a turn is a step to the right.

::

    Z = i log(z - centre)        xi runs along the real axis, 2 pi once around; eta along the imaginary one

The map is conformal, so that Winslow's equations and the angles of cells are the same in both, and turning,
moving and scaling a body only moves its strip. What is even in the strip grows evenly outwards in the plane.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats

AROUND = 65
"""Nodes along xi, the last a turn after the first, of the grid that the network sees around a body."""

TURN = 2.0 * np.pi


def middles(walls: Complexes) -> Complexes:
    """Return the centroids (batch,) of the areas inside closed curves (batch, n), first node not repeated."""
    off = walls - walls[:, :1]  # near the origin, against cancellation
    ahead = np.roll(off, -1, axis=1)
    cross = (off.conj() * ahead).imag
    return np.asarray(walls[:, 0] + (cross * (off + ahead)).sum(axis=1) / (3.0 * cross.sum(axis=1)))


def unrolled(z: Complexes, centres: Complexes) -> tuple[Complexes, NDArray[np.bool_]]:
    """Return the strips of closed O grids `z` (batch, m + 1, n), and which of them go round once."""
    off = z - centres[:, None, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        cut = np.angle(off[:, :1, 1:] / off[:, :1, :-1])
        first = np.cumsum(np.concatenate([np.angle(off[:, :1, :1]), cut], axis=2), axis=2)
        steps = np.angle(off[:, 1:] / off[:, :-1])
        angle = np.cumsum(np.concatenate([first, steps], axis=1), axis=1)
        strip = -angle + 1j * np.log(np.abs(off))
    gone = np.abs(angle[:, -1] - angle[:, 0] + TURN) < 1e-6
    once = gone.all(axis=1) & np.isfinite(strip).all(axis=(1, 2))
    strip[:, -1] = strip[:, 0] + TURN
    return strip, once


def even(strips: Complexes, n: int) -> Complexes:
    """Return strips (batch, m + 1, n) with even steps between the first and the last row of `strips`."""
    eta = np.linspace(0.0, 1.0, n)
    return np.asarray(strips[:, :, :1] * (1.0 - eta) + strips[:, :, -1:] * eta)


def factors(strips: Complexes) -> Floats:
    """Return what each strip (batch, m + 1, n) is multiplied by so that half a turn of it has area 1."""
    heights = (strips[:, :-1, -1] - strips[:, :-1, 0]).imag.mean(axis=1)
    return np.asarray(1.0 / np.sqrt(0.5 * TURN * heights))


def rolled(strips: Complexes, centres: Complexes | complex = 0.0) -> Complexes:
    """Return the O grids of `strips` (batch, m + 1, n)."""
    return np.asarray(np.exp(-1j * strips) + np.reshape(centres, (-1, 1, 1)))
