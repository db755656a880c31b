"""Random shapes of nine kinds, by seed: the boundaries of four-sided domains and of O grids around bodies.

They are drawn for this comparison alone: no network of this repository was trained on them, and no method
was tuned to them. Every shape depends on kind, seed and number alone.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Shape:
    """A boundary: sides (n, 2) that share corners. Of topology ``o``, south is the body, clockwise, north the
    far field, both closed, and west and east are the cut between them.
    """  # noqa: D205

    name: str
    topology: str
    south: Floats
    north: Floats
    west: Floats
    east: Floats


def shapes(kind: str, seed: int, count: int, ni: int = 65, nj: int = 65) -> Iterator[Shape]:
    """Yield `count` shapes of a kind with ni x nj nodes."""
    draw = KINDS[kind]
    number = list(KINDS).index(kind)
    for k in range(count):
        rng = np.random.default_rng([seed, number, k])
        south, north, west, east = draw(rng, ni, nj)
        for side, end in ((west, 0), (east, -1)):  # corners are the same numbers in both sides
            side[0], side[-1] = south[end], north[end]
        yield Shape(f"{kind}-{k}", "o" if kind in BODIES else "quad", south, north, west, east)


def wavy(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return a quadrilateral whose sides are waves of up to three periods."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + rng.uniform(-0.15, 0.15, (4, 2))
    corners[:, 0] *= rng.uniform(1.0, 2.5)

    def side(a: Floats, b: Floats, n: int) -> Floats:
        t = _steps(rng, n)
        height = sum(rng.uniform(-0.1, 0.1) / k * np.sin(k * np.pi * t) for k in (1, 2, 3, 6))
        chord = b - a
        return a + t[:, None] * chord + height[:, None] * np.array([-chord[1], chord[0]])

    a, b, c, d = corners
    return side(a, b, ni), side(d, c, ni), side(a, d, nj), side(b, c, nj)


def sector(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return a piece of a ring of 40 to 270 degrees, whose radii vary along it."""
    turn = np.radians(rng.uniform(40, 270))
    inner, width = rng.uniform(0.3, 2.0), rng.uniform(0.4, 2.0)
    phases, sizes = rng.uniform(0, 2 * np.pi, 2), rng.uniform(0, 0.15, 2)

    def arc(radius: float, k: int, t: Floats) -> Floats:
        r = radius * (1 + sizes[k] * np.sin((k + 1) * turn * t + phases[k]))
        return np.stack([-r * np.cos(turn * t), r * np.sin(turn * t)], 1)

    t = _steps(rng, ni)
    south, north = arc(inner, 0, t), arc(inner + width, 1, t)
    return south, north, *_across(rng, south, north, nj)


def duct(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return an S-shaped duct with contractions."""
    t = _steps(rng, ni)
    length, bend = rng.uniform(2, 5), rng.uniform(0.2, 0.9)
    slope = bend * np.sin(np.linspace(0, 2 * np.pi, 4001)) * rng.choice([-1, 1])
    fine = np.linspace(0, 1, 4001)
    middle = np.stack([_summed(np.cos(slope)), _summed(np.sin(slope))], 1) * length
    middle = np.stack([np.interp(t, fine, middle[:, k]) for k in (0, 1)], 1)
    angle = np.interp(t, fine, slope)
    width = 0.35 * (1 + rng.uniform(-0.5, 0.5) * np.exp(-(((t - rng.uniform(0.3, 0.7)) / 0.12) ** 2)))
    normal = np.stack([-np.sin(angle), np.cos(angle)], 1) * width[:, None]
    south, north = middle - normal, middle + normal
    return south, north, *_across(rng, south, north, nj)


def bumps(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return a channel with one to three bumps on its floor and one on its ceiling."""
    x = 3 * _steps(rng, ni)
    floor = sum(
        rng.uniform(0.1, 0.45) * np.exp(-(((x - rng.uniform(0.5, 2.5)) / rng.uniform(0.1, 0.35)) ** 2))
        for _ in range(rng.integers(1, 4))
    )
    roof = 1.2 + rng.uniform(-0.1, 0.3) * np.exp(-(((x - rng.uniform(0.5, 2.5)) / 0.3) ** 2))
    south, north = np.stack([x, np.minimum(floor, 0.8)], 1), np.stack([x, roof], 1)
    return south, north, *_across(rng, south, north, nj)


def kinked(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return a quadrilateral whose sides are polylines with one or two kinks."""
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + rng.uniform(-0.12, 0.12, (4, 2))

    def side(a: Floats, b: Floats, n: int) -> Floats:
        at = np.sort(rng.choice(np.arange(2, 9), rng.integers(1, 3), replace=False)) / 10.0
        chord = b - a
        off = rng.uniform(-0.18, 0.18, len(at))
        inner = a + at[:, None] * chord + off[:, None] * np.array([-chord[1], chord[0]])
        points = np.vstack([a, inner, b])
        return np.stack([np.interp(np.linspace(0, 1, n), [0, *at, 1], points[:, k]) for k in (0, 1)], 1)

    a, b, c, d = corners
    return side(a, b, ni), side(d, c, ni), side(a, d, nj), side(b, c, nj)


def lens(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return a domain between two arcs with sharp corners of 25 to 70 degrees, cut off at its ends."""
    t = _steps(rng, ni)
    half = np.radians(rng.uniform(25, 70)) / 2
    x, cut = 2 * t - 1, rng.uniform(0.02, 0.2)
    height = np.tan(half) * (1 - x**2) / 2 + cut
    lean = rng.uniform(-0.4, 0.4)
    south = np.stack([x, -height + lean * x**2], 1)
    north = np.stack([x, height + lean * x**2], 1)
    return south, north, *_across(rng, south, north, nj)


def star(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return a smooth body with two to seven lobes, and a circle around it."""
    lobes, size = rng.integers(2, 8), rng.uniform(0.05, 0.3)
    angle = _around(ni)
    r = 1 + size * np.cos(lobes * angle + rng.uniform(0, 6)) + rng.uniform(0, 0.1) * np.sin(angle)
    return _ring(rng, r[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1), nj, 3.0, 12.0)


def slab(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return a rectangle with rounded corners, and a circle around it."""
    power, flat = rng.uniform(2.5, 6), rng.uniform(0.15, 1)
    angle = _around(ni)
    c, s = np.cos(angle), np.sin(angle)
    r = (np.abs(c) ** power + np.abs(s / flat) ** power) ** (-1 / power)
    return _ring(rng, r[:, None] * np.stack([c, s], 1), nj, 3.0, 12.0)


def section(rng: np.random.Generator, ni: int, nj: int) -> tuple[Floats, ...]:
    """Return an airfoil of the four-digit NACA series, closed, and a circle of 5 to 20 chords around it."""
    camber, place, thick = rng.uniform(0, 0.06), rng.uniform(0.3, 0.6), rng.uniform(0.08, 0.2)
    turn = np.linspace(0, 2 * np.pi, ni)
    x = (1 + np.cos(turn)) / 2
    y = 5 * thick * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    front = x < place
    line = np.where(
        front, camber / place**2 * (2 * place * x - x**2),
        camber / (1 - place) ** 2 * (1 - 2 * place + 2 * place * x - x**2),
    )  # fmt: skip
    body = np.stack([x, line + np.where(turn <= np.pi, -1, 1) * y], 1)
    return _ring(rng, body, nj, 5.0, 20.0)


BODIES = ("star", "slab", "section")
KINDS: dict[str, Callable[[np.random.Generator, int, int], tuple[Floats, ...]]] = {
    "wavy": wavy, "sector": sector, "duct": duct, "bumps": bumps, "kinked": kinked, "lens": lens,
    "star": star, "slab": slab, "section": section,
}  # fmt: skip


def _steps(rng: np.random.Generator, n: int) -> Floats:
    """Return parameters (n,) from 0 to 1, even or denser at both ends."""
    s = np.linspace(0, 1, n)
    dense = rng.uniform(0, 2)
    return s if dense < 0.8 else 0.5 * (1 + np.tanh(dense * (2 * s - 1)) / np.tanh(dense))


def _summed(slope: Floats) -> Floats:
    """Return the integral from 0 to 1 by trapezia."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]))]) / (len(slope) - 1)


def _across(rng: np.random.Generator, south: Floats, north: Floats, nj: int) -> tuple[Floats, Floats]:
    """Return straight lines between the ends of two sides."""
    t = _steps(rng, nj)[:, None]
    lines = [(1 - t) * south[k] + t * north[k] for k in (0, -1)]
    return lines[0], lines[1]


def _around(ni: int) -> Floats:
    """Return angles (ni,) of one clockwise turn."""
    return -2 * np.pi * np.arange(ni) / (ni - 1)


def _ring(rng: np.random.Generator, body: Floats, nj: int, near: float, far: float) -> tuple[Floats, ...]:
    """Return a closed body (clockwise), a circle around it, and the cut between both, denser at the body."""
    turn = rng.uniform(-0.5, 0.5)
    body = body @ np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    body[-1] = body[0]
    start = np.arctan2(*(body[0] - body.mean(axis=0))[::-1])
    angle = start + _around(len(body))
    circle = rng.uniform(near, far) * np.stack([np.cos(angle), np.sin(angle)], 1)
    circle[-1] = circle[0]
    dense = rng.uniform(1.0, 2.5)
    t = 1 + np.tanh(dense * (np.linspace(0, 1, nj) - 1)) / np.tanh(dense)
    cut = body[0] + t[:, None] * (circle[0] - body[0])
    return body, circle, cut, cut.copy()
