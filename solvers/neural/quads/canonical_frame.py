"""Boundaries of bodies in a frame of their own, where steps after the network are taken.

Descents amplify rounding: thirty steps in a window around a corner turn 1e-16 into 1e-3. So that a body
moved, turned, scaled or mirrored takes the same steps to the bit, its walls are taken to the frame in which
the cut is from 0 to 1, rounded there to 1e-9 of their size, and mirrored when their mirror image comes first.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.far_field import straight

STEP = 2.0**-30
"""Of the rounding, over the size of the walls up to the next power of two."""


@dataclass(frozen=True)
class OwnFrame:
    """The frame of an O boundary, and what it is there.

    Parameters
    ----------
    given : the boundary.
    boundary : the same in the frame, its walls rounded.
    mirrored, symmetric : it is mirrored there; it is its own mirror image.
    """

    given: Boundary
    boundary: Boundary
    mirrored: bool
    symmetric: bool

    @classmethod
    def of(cls, given: Boundary) -> OwnFrame:
        """Return the frame of `given`."""
        walls = np.stack([complex_edge(given.south), complex_edge(given.north)])
        walls = (walls - walls[0, 0]) / (walls[1, 0] - walls[0, 0])
        step = rounding(np.abs(walls).max())
        rounded = step * np.round(np.stack([walls.imag, walls.real], axis=-1) / step) + 0.0  # no -0
        image = rounded[:, ::-1] * [-1.0, 1.0] + 0.0
        apart = np.flatnonzero(rounded.ravel() != image.ravel())
        mirrored = bool(len(apart) and rounded.ravel()[apart[0]] < image.ravel()[apart[0]])
        south, north = (image if mirrored else rounded)[..., ::-1].copy()
        cut = straight(south[0], north[0], given.nj)
        inner = replace(given, south=south, north=north, west=cut, east=cut, chord=0.0)
        return cls(given, inner, mirrored, len(apart) == 0)

    def back(self, planes: Floats) -> Floats:
        """Return the planes (2, ni, nj) of a grid in the frame, in the given boundary."""
        z = planes[0] + 1j * planes[1]
        if self.symmetric:
            both = 0.5 * (z + z[::-1].conj())
            folded = count_folded(np.stack([both.real, both.imag], axis=-1))
            z = both if folded <= count_folded(np.moveaxis(planes, 0, -1)) else z
        elif self.mirrored:
            z = z[::-1].conj()
        south, north = complex_edge(self.given.south), complex_edge(self.given.north)
        z = south[0] + (north[0] - south[0]) * z
        z[:, 0], z[:, -1] = south, north
        z[-1] = z[0]
        return np.stack([z.real, z.imag])


def rounding(size: float) -> float:
    """Return what numbers up to `size` are rounded to multiples of."""
    return float(STEP * 2.0 ** np.ceil(np.log2(size)))


def complex_edge(edge: Floats) -> Complexes:
    """Return nodes (n, 2) as x + iy."""
    return np.asarray(edge[:, 0] + 1j * edge[:, 1])
