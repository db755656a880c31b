"""Random four-sided domains, to train and test operators.

Sides between displaced corners are deflected; some domains are tapered, bent or warped as a whole.
"""

import math
from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, pairs_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import angle, exp, expm1, power, product, sin, tanh, times
from meshonet.geometry.families.bodies import arc_lengths, at_lengths
from meshonet.geometry.polygon.self_intersection import find_crossing

FINE = 601  # points of a side before nodes are placed on it
CHECKED = 65  # nodes per side with which a domain is accepted, so that a seed gives one shape for all counts
LEAST, MOST = np.radians(3.0), np.radians(178.0)  # angles of the four corners
LEAST_AREA = 0.05  # in units of the unit square: a smaller outline is drawn again
CORNERS = np.array([0.0, 1.0, 1.0 + 1.0j, 1.0j])  # corners of the square whose sides are deflected
ENDS = ((0, 1), (3, 2), (0, 3), (1, 2))  # corners where south, north, west and east begin and end


def boundary(rng: np.random.Generator, ni: int, nj: int) -> Boundary:
    """Return a random quad boundary with a simple outline and corner angles from 3 to 178 degrees."""
    while True:
        sides = _sides(rng)
        laws = [_law(rng) for _ in sides]
        if _usable([_placed(side, law, CHECKED) for side, law in zip(sides, laws, strict=True)]):
            break
    counts = ni, ni, nj, nj
    nodes = [pairs_of(_placed(*each)) for each in zip(sides, laws, counts, strict=True)]
    south, north, west, east = nodes
    west[[0, -1]], east[[0, -1]] = (south[0], north[0]), (south[-1], north[-1])
    return Boundary(south, north, west, east, "quad")


def _sides(rng: np.random.Generator) -> list[Complexes]:
    """Return the sides south, north, west and east, `FINE` points (FINE,) each."""
    spread = rng.choice([0.13, 0.2], p=[0.6, 0.4])
    corners = CORNERS + rng.normal(0, spread, 4) + 1j * rng.normal(0, spread, 4)
    if rng.random() < 0.35:  # tapers to a tail
        pulled = rng.integers(4)
        corners[pulled] += rng.uniform(0.3, 1.2) * (CORNERS[pulled] - CORNERS.mean())
    stretch = math.exp(0.5 * rng.uniform(-0.9, 0.9))
    corners = corners.real * stretch + 1j * corners.imag / stretch
    swing = rng.choice([0.35, 0.7, 1.0], p=[0.4, 0.35, 0.25])
    sides = [_side(corners[a], corners[b], swing, rng) for a, b in ENDS]
    if rng.random() < 0.35:
        sides = _bent(sides, rng)
    if rng.random() < 0.25:
        middle = np.concatenate(sides).mean()
        by = rng.normal(0, 0.12) * exp(2j * np.pi * rng.random())
        sides = [side - middle + times(by, times(side - middle, side - middle)) for side in sides]
    return sides


def _side(a: complex, b: complex, swing: float, rng: np.random.Generator) -> Complexes:
    """Return a line from `a` to `b` with one or two deflections, scaled by `swing`."""
    t = np.linspace(0.0, 1.0, FINE)
    kinds = rng.choice(len(DEFLECTIONS), size=rng.choice([1, 2], p=[2 / 3, 1 / 3]), replace=False, p=SHARES)
    height = sum(DEFLECTIONS[kind](t, rng) for kind in kinds)
    return np.asarray(a + times(b - a, t + 1j * swing * height))


def _wave(t: Floats, rng: np.random.Generator) -> Floats:
    k = np.arange(1, 9)
    heights = rng.normal(size=8) / power(k, rng.uniform(1.2, 2.2)) * rng.uniform(0.05, 0.5)
    return np.asarray(product(heights, sin(np.pi * np.outer(k, t))))


def _kinks(t: Floats, rng: np.random.Generator) -> Floats:
    count = rng.integers(1, 4)
    at, heights = np.sort(rng.uniform(0.12, 0.88, count)), rng.uniform(-0.3, 0.3, count)
    return np.interp(t, np.r_[0.0, at, 1.0], np.r_[0.0, heights, 0.0])


def _bump(t: Floats, rng: np.random.Generator) -> Floats:
    at, width = rng.uniform(0.2, 0.8), rng.uniform(0.05, 0.25)
    bell = exp(-(((t - at) / width) ** 2))
    return np.asarray(rng.uniform(-0.35, 0.4) * (bell - bell[0] * (1 - t) - bell[-1] * t))


def _arc(t: Floats, rng: np.random.Generator) -> Floats:
    """Return a part of an ellipse that meets the side at right angles."""
    at, radius = rng.uniform(0.3, 0.7), rng.uniform(0.1, 0.28)
    rise = np.sqrt(np.maximum(1.0 - ((t - at) / radius) ** 2, 0.0))
    return np.asarray(1.5 * radius * rng.uniform(-0.6, 0.6) * rise)


DEFLECTIONS: tuple[Callable[[Floats, np.random.Generator], Floats], ...] = (
    lambda t, _: 0.0 * t,
    _wave,
    lambda t, rng: np.asarray(rng.uniform(-1.3, 1.4) * t * (1 - t)),
    _kinks,
    _bump,
    _arc,
)
SHARES = (0.12, 0.26, 0.16, 0.2, 0.16, 0.1)  # probabilities of these deflections


def _bent(sides: list[Complexes], rng: np.random.Generator) -> list[Complexes]:
    """Return the sides with the x axis bent into an arc of 0.3 to 3.6 radians."""
    every = np.concatenate(sides)
    length, height = np.ptp(every.real), np.ptp(every.imag)
    radius = max(length / rng.uniform(0.3, 3.6), height * rng.uniform(0.6, 1.5))
    up = rng.choice([-1.0, 1.0])
    middle = 0.5 * (every.real.min() + every.real.max())
    inner = every.imag.min() if up > 0 else every.imag.max()
    return [
        (radius + up * (side.imag - inner)) * exp(1j * up * (np.pi / 2 - (side.real - middle) / radius))
        for side in sides
    ]


def _law(rng: np.random.Generator) -> Callable[[Floats], Floats]:
    """Return a node distribution, a rising map of [0, 1] to itself, mostly uniform."""
    draw = rng.random()
    if draw < 0.25:
        shift = rng.uniform(-0.12, 0.12)
        return lambda q: np.asarray(q + shift * sin(2 * np.pi * q))
    if draw < 0.4:
        pull = rng.uniform(0.3, 1.6) * rng.choice([-1.0, 1.0])
        return lambda q: np.asarray(expm1(pull * q) / math.expm1(pull))
    if draw < 0.5:
        both = rng.uniform(0.3, 1.4)
        return lambda q: np.asarray(0.5 * (1 + tanh(both * (2 * q - 1)) / math.tanh(both)))
    return lambda q: q


def _placed(side: Complexes, law: Callable[[Floats], Floats], n: int) -> Complexes:
    """Return n nodes on a side, by arc length."""
    length = arc_lengths(side)
    return at_lengths(side, length, law(np.linspace(0.0, 1.0, n)) * length[-1])


def _usable(sides: list[Complexes]) -> bool:
    south, north, west, east = sides
    outline = np.concatenate([south[:-1], east[:-1], north[:0:-1], west[:0:-1]])
    area = 0.5 * times(np.conj(outline), np.roll(outline, -1)).imag.sum()
    if area <= LEAST_AREA:
        return False
    corners = (
        (south[1] - south[0], west[1] - west[0]),
        (east[1] - east[0], south[-2] - south[-1]),
        (north[-2] - north[-1], east[-2] - east[-1]),
        (west[-2] - west[-1], north[1] - north[0]),
    )
    if not all(LEAST < angle(v / u) < MOST for u, v in corners):
        return False
    return find_crossing(pairs_of(outline)) is None
