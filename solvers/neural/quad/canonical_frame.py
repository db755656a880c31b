"""Boundaries in a canonical frame, in which the steps after the network are computed."""

import math
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, complex_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import modulus, times
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.far_field import straight

STEP = 2.0**-30  # of the rounding, over the size of the edges rounded up to a power of two

LEAST = 0.1  # mean side along xi over the size, below which a diagonal defines the direction of the frame

Element = tuple[bool, bool, bool]  # xi runs the other way, eta does, both change places

IDENTITY: Element = (False, False, False)  # of a boundary that stays as it is


@dataclass(frozen=True)
class Canonical:
    """A boundary, and its image with standard position, direction, size and order of sides."""

    original: Boundary
    boundary: Boundary  # the same in the frame, its edges rounded and relabelled
    element: Element
    origin: complex  # a point u there is ``origin + unit u`` here, its conjugate if the element mirrors
    unit: complex
    symmetric: bool = False  # an O boundary that is its own mirror image

    def back(self, planes: Floats) -> Floats:
        """Return a grid `planes` (2, ni, nj), moved from the canonical frame to the frame of the boundary."""
        z = planes[0] + 1j * planes[1]
        along, across, transposed = self.element
        if self.symmetric:
            both = 0.5 * (z + z[::-1].conj())
            folded = count_folded(np.stack([both.real, both.imag], axis=-1))
            z = both if folded <= count_folded(np.moveaxis(planes, 0, -1)) else z
        z = z.T if transposed else z
        z = z[:: -1 if along else 1, :: -1 if across else 1]
        z = self.origin + times(self.unit, (z.conj() if _mirrors(self.element) else z))
        own = self.original
        z[:, 0], z[:, -1] = complex_of(own.south), complex_of(own.north)
        z[0], z[-1] = (z[0], z[0]) if own.topology == "o" else (complex_of(own.west), complex_of(own.east))
        return np.stack([z.real, z.imag])


def canonical(boundary: Boundary) -> Canonical:
    """Return a four-sided or O boundary in its canonical frame, rounded to 1e-9 of the domain's size.

    Boundaries that differ by translation, rotation, scaling, mirroring or names of sides get bitwise equal
    nodes. A four-sided boundary stays unchanged if rounding would merge its nodes.
    """
    return _of_body(boundary) if boundary.periodic else _of_quad(boundary)


def _of_body(boundary: Boundary) -> Canonical:
    south, north = complex_of(boundary.south), complex_of(boundary.north)
    origin, unit = south[0], north[0] - south[0]
    walls = (np.stack([south, north]) - origin) / unit
    step = _step(walls)
    rounded = step * np.round(np.stack([walls.imag, walls.real], axis=-1) / step) + 0.0  # no -0
    image = rounded[:, ::-1] * [-1.0, 1.0] + 0.0
    apart = np.flatnonzero(rounded.ravel() != image.ravel())
    mirrored = bool(len(apart) and rounded.ravel()[apart[0]] < image.ravel()[apart[0]])
    body, far = (image if mirrored else rounded)[..., ::-1].copy()
    cut = straight(body[0], far[0], boundary.nj)
    inner = replace(boundary, south=body, north=far, west=cut, east=cut, chord=0.0)
    return Canonical(boundary, inner, (mirrored, False, False), origin, unit, symmetric=len(apart) == 0)


def _of_quad(boundary: Boundary) -> Canonical:
    sides = tuple(complex_of(side) for side in (boundary.south, boundary.north, boundary.west, boundary.east))
    transposed = (False, True) if boundary.ni == boundary.nj else (False,)
    images = [(*_framed(sides, e), e) for e in product((False, True), (False, True), transposed)]
    rounded, origin, unit, element = min(images, key=lambda image: b"".join(s.tobytes() for s in image[0]))
    south, north, west, east = (np.stack([side.real, side.imag], axis=-1) for side in rounded)
    try:
        inner = Boundary(south, north, west, east, "quad", name=boundary.name)
    except InputError:  # nodes nearer to each other than the rounding
        return Canonical(boundary, boundary, IDENTITY, 0.0, 1.0)
    return Canonical(boundary, inner, element, origin, unit)


def _framed(sides: tuple[Complexes, ...], element: Element) -> tuple[tuple[Complexes, ...], complex, complex]:
    """Return the sides of a quad in their frame, relabelled by `element`, and its origin and unit."""
    south, north, west, east = sides
    along, across, transposed = element
    if along:
        south, north, west, east = south[::-1], north[::-1], east, west
    if across:
        south, north, west, east = north, south, west[::-1], east[::-1]
    if transposed:
        south, north, west, east = west, east, south, north
    a, b, c, d = south[0], south[-1], north[-1], north[0]
    origin, side, diagonal = 0.25 * (a + b + c + d), 0.5 * (b + c - a - d), c - a
    size = max(abs(corner - origin) for corner in (a, b, c, d))
    unit = complex(side if abs(side) > LEAST * size else diagonal)
    framed = tuple((edge - origin) / unit for edge in (south, north, west, east))
    framed = tuple(edge.conj() for edge in framed) if _mirrors(element) else framed
    step = _step(np.concatenate(framed))
    # no -0
    framed = tuple(step * (np.round(z.real / step) + 1j * np.round(z.imag / step)) + 0.0 for z in framed)
    return framed, complex(origin), unit


def _step(edges: Complexes) -> float:
    return STEP * 2.0 ** math.ceil(math.log2(modulus(edges).max()))


def _mirrors(element: Element) -> bool:
    return sum(element) % 2 == 1
