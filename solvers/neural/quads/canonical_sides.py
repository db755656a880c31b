"""Four-sided domains in a frame of their own, where steps after the network are taken (cf. `own_frame`).

Steps amplify rounding, and those of Newton's method are led by single precision. So that a domain moved,
turned, scaled, mirrored or named otherwise takes the same steps to the bit, its sides are taken to the frame
of its corners, rounded there to 1e-9 of their size, and named as the first of its images is.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.quads.canonical_frame import complex_edge, rounding

Element = tuple[bool, bool, bool]
"""A relabelling: xi runs the other way, then eta does, then both change places."""

PLAIN: Element = (False, False, False)

LEAST = 0.1
"""Mean side along xi, over the size, that is long enough to tell a direction; else a diagonal does."""


@dataclass(frozen=True)
class OwnSides:
    """The frame of a quad boundary, and what it is there.

    Parameters
    ----------
    given : the boundary.
    boundary : the same in the frame, its sides rounded and named anew.
    element : how they are named.
    origin, unit : a place u there is ``origin + unit u`` here, its conjugate if the element mirrors.
    """

    given: Boundary
    boundary: Boundary
    element: Element
    origin: complex
    unit: complex

    @classmethod
    def of(cls, given: Boundary) -> OwnSides:
        """Return the frame of `given`: where it cannot be rounded, that of all."""
        sides = tuple(complex_edge(side) for side in (given.south, given.north, given.west, given.east))
        transposed = (False, True) if given.ni == given.nj else (False,)
        found = [(*_framed(sides, one), one) for one in product((False, True), (False, True), transposed)]
        rounded, origin, unit, element = min(found, key=lambda one: b"".join(s.tobytes() for s in one[0]))
        south, north, west, east = (np.stack([side.real, side.imag], axis=-1) for side in rounded)
        try:
            inner = Boundary(south, north, west, east, "quad", name=given.name)
            return cls(given, inner, element, origin, unit)
        except InputError:  # nodes nearer to each other than the rounding
            return cls(given, given, PLAIN, 0.0, 1.0)

    def back(self, planes: Floats) -> Floats:
        """Return the planes (2, ni, nj) of a grid in the frame, in the given boundary."""
        z = planes[0] + 1j * planes[1]
        along, across, turned = self.element
        z = z.T if turned else z
        z = z[:: -1 if along else 1, :: -1 if across else 1]
        z = self.origin + self.unit * (z.conj() if _mirrors(self.element) else z)
        south, north = complex_edge(self.given.south), complex_edge(self.given.north)
        z[:, 0], z[:, -1] = south, north
        z[0], z[-1] = complex_edge(self.given.west), complex_edge(self.given.east)
        return np.stack([z.real, z.imag])


def _framed(sides: tuple[Complexes, ...], element: Element) -> tuple[tuple[Complexes, ...], complex, complex]:
    """Return the sides in their frame, named by `element`, and its origin and unit."""
    south, north, west, east = sides
    along, across, turned = element
    if along:
        south, north, west, east = south[::-1], north[::-1], east, west
    if across:
        south, north, west, east = north, south, west[::-1], east[::-1]
    if turned:
        south, north, west, east = west, east, south, north
    a, b, c, d = south[0], south[-1], north[-1], north[0]
    origin, side, diagonal = 0.25 * (a + b + c + d), 0.5 * (b + c - a - d), c - a
    size = max(abs(corner - origin) for corner in (a, b, c, d))
    unit = complex(side if abs(side) > LEAST * size else diagonal)
    named = tuple((one - origin) / unit for one in (south, north, west, east))
    named = tuple(one.conj() for one in named) if _mirrors(element) else named
    step = rounding(max(np.abs(one).max() for one in named))
    return tuple(_rounded(one, step) for one in named), complex(origin), unit


def _rounded(side: Complexes, step: float) -> Complexes:
    return np.asarray(step * (np.round(side.real / step) + 1j * np.round(side.imag / step)) + 0.0)  # no -0


def _mirrors(element: Element) -> bool:
    return sum(element) % 2 == 1
