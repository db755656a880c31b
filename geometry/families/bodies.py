"""Random bodies in far fields 1.6 to 25 times their size, to train and test operators on O grids."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, pairs_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import angle, cos, exp, modulus, power, product, sin, times
from meshonet.geometry.polygon.area import contains
from meshonet.geometry.polygon.self_intersection import find_crossing
from meshonet.geometry.shapes.far_field import straight
from meshonet.geometry.spacing.along_curve import on_corners

FINE = 960  # points of a curve before nodes are placed on it
CLEARANCE = 0.12  # least distance between body and far field, in mean radii of the body
BEND = np.radians(25.0)  # a turn at a point of a curve that makes it a corner


class BodyCurve(NamedTuple):
    """A closed curve, counter-clockwise around 0, that does not repeat its first point.

    `corners` are the indices of points that are corners.
    """

    points: Complexes
    corners: tuple[int, ...] = ()


def boundary(rng: np.random.Generator, ni: int, nj: int) -> Boundary:
    """Return a random O boundary: a simple body with its centroid at 0, and a far field around it."""
    while True:
        body, far = _body(rng), _far(rng)
        placed = _placed_within(body, far, rng)
        if placed is None:
            continue
        far = BodyCurve(far.points - placed, far.corners)
        if not np.all(np.diff(np.unwrap(angle(far.points))) > 0.0):
            continue  # every point of the far field must be visible from the body
        laws = _law(rng), _law(rng) if rng.random() < 0.3 else _even
        start, twist = rng.random() * 2 * np.pi, rng.normal(0.0, 0.12) if rng.random() < 0.4 else 0.0
        turn = exp(2j * np.pi * rng.random())
        break
    first = _facing(body.points, start)
    south = times(_nodes(body, first, laws[0], ni), turn)
    north = times(
        _nodes(far, _facing(far.points, float(angle(body.points[first])) + twist), laws[1], ni), turn
    )
    walls = pairs_of(south), pairs_of(north)
    cut = straight(walls[0][0], walls[1][0], nj)
    return Boundary(walls[0], walls[1], cut, cut, topology="o")


def _placed_within(body: BodyCurve, far: BodyCurve, rng: np.random.Generator) -> complex | None:
    """Return a position for the body inside `far`, or None if it does not fit."""
    if find_crossing(pairs_of(body.points)) is not None or not contains(pairs_of(body.points), np.zeros(2)):
        return None
    where = complex(0.75 * rng.random() * far.points[rng.integers(len(far.points))])
    if rng.random() < 0.2:
        where = 0.0
    moved = body.points + where
    gap = modulus(moved[::4, None] - far.points[None, ::2]).min()
    inside = contains(pairs_of(far.points), pairs_of(moved[:: FINE // 24])).all()
    return where if inside and gap > CLEARANCE else None


def _even(q: Floats) -> Floats:
    return q


def _law(rng: np.random.Generator) -> Callable[[Floats], Floats]:
    """Return a random node distribution, a rising map of [0, 1] to itself."""
    if rng.random() < 0.5:
        return _even
    k = np.arange(1, 4)
    heights = rng.uniform(0.0, 0.6) * rng.dirichlet(np.ones(3)) / (2 * np.pi * k)
    phases = rng.uniform(0.0, 2 * np.pi, 3)
    return lambda q: q + product(sin(2 * np.pi * np.outer(q, k) + phases) - sin(phases), heights)


def _facing(ring: Complexes, direction: float) -> int:
    """Return the index of the outermost point in a `direction` (radians) from 0."""
    off = np.abs(angle(times(ring, exp(-1j * direction))))
    near = np.flatnonzero(off < off.min() + 2 * np.pi / len(ring))
    return int(near[np.argmax(modulus(ring[near]))])


def _nodes(ring: BodyCurve, first: int, law: Callable[[Floats], Floats], n: int) -> Complexes:
    """Return n nodes clockwise from the point `first` back to it; corners are nodes."""
    m = len(ring.points)
    points = np.roll(ring.points, -first)[::-1]
    points = np.concatenate([points[-1:], points])  # clockwise, closed
    length = arc_lengths(points)
    corners = np.sort([length[(first - k) % m] for k in ring.corners if k != first])
    at = on_corners(law(np.linspace(0.0, 1.0, n)) * length[-1], np.asarray(corners))
    nodes = at_lengths(points, length, at)
    nodes[-1] = nodes[0]
    return nodes


def _body(rng: np.random.Generator) -> BodyCurve:
    """Return a body with its centroid at 0 and mean radius 1."""
    kinds = _ellipse, _polygon, _rounded, _star, _superellipse, _bullet
    ring = kinds[rng.choice(len(kinds), p=(0.22, 0.24, 0.14, 0.16, 0.14, 0.1))](rng)
    z = ring.points
    ahead = np.roll(z, -1)
    cross = times(np.conj(z), ahead).imag
    z = z - (cross * (z + ahead)).sum() / (3.0 * cross.sum())
    return BodyCurve(z / modulus(z).mean(), ring.corners)


def _far(rng: np.random.Generator) -> BodyCurve:
    kinds = _ellipse, _rectangle, _polygon, _superellipse
    ring = kinds[rng.choice(len(kinds), p=(0.45, 0.35, 0.08, 0.12))](rng)
    size = math.exp(rng.uniform(math.log(1.6), math.log(25.0)))
    return BodyCurve(size * ring.points / modulus(ring.points).mean(), ring.corners)


def _stretched(z: Complexes, most: float, rng: np.random.Generator) -> Complexes:
    """Return the curve stretched along one axis by up to `most`; one in three is not changed."""
    ratio = math.exp(rng.uniform(0.0, 0.5 * math.log(most))) if rng.random() < 2 / 3 else 1.0
    return times(z.real * ratio + 1j * z.imag / ratio, exp(2j * np.pi * rng.random()))


def _angles() -> Floats:
    return 2 * np.pi * np.arange(FINE) / FINE


def _ellipse(rng: np.random.Generator) -> BodyCurve:
    return BodyCurve(_stretched(exp(1j * _angles()), 4.0, rng))


def _superellipse(rng: np.random.Generator) -> BodyCurve:
    t, exponent = _angles(), 2.0 / math.exp(rng.uniform(math.log(2.5), math.log(8.0)))
    x, y = cos(t), sin(t)
    z = np.sign(x) * power(np.abs(x), exponent) + 1j * np.sign(y) * power(np.abs(y), exponent)
    return BodyCurve(_stretched(_even_steps(z), 3.0, rng))


def _star(rng: np.random.Generator) -> BodyCurve:
    t, k = _angles(), np.arange(2, 8)
    heights = rng.normal(size=6) / power(k, rng.uniform(1.0, 2.0)) * rng.uniform(0.1, 0.9)
    radius = exp(product(cos(np.outer(t, k) + rng.uniform(0, 2 * np.pi, 6)), heights) * 0.7)
    return BodyCurve(_stretched(_even_steps(radius * exp(1j * t)), 1.5, rng))


def _bullet(rng: np.random.Generator) -> BodyCurve:
    """Return a circular arc closed by straight pieces: a D, or a bullet with a flat base."""
    reach = rng.uniform(0.35, 0.6) * np.pi
    arc = exp(1j * np.linspace(-reach, reach, 60))
    length = rng.uniform(0.0, 1.6) if rng.random() < 0.6 else 0.0
    tail = [arc[-1] - length, arc[0] - length] if length > 0.05 else []
    return _through(_stretched(np.append(arc, tail), 1.5, rng))


def _rectangle(rng: np.random.Generator) -> BodyCurve:
    ratio = math.exp(0.5 * rng.uniform(0.0, math.log(4.0))) if rng.random() < 0.6 else 1.0
    corners = np.array([1 + 1j, -1 + 1j, -1 - 1j, 1 - 1j])
    return _through(corners.real * ratio + 1j * corners.imag / ratio)


def _polygon(rng: np.random.Generator) -> BodyCurve:
    draw = rng.random()
    if draw < 0.35:
        return _rectangle(rng)
    count = int(rng.integers(3, 9))
    t = 2 * np.pi * np.arange(count) / count
    if draw < 0.5:
        return _through(_stretched(exp(1j * t), 2.5, rng))
    t = t + rng.uniform(-0.3, 0.3, count) * 2 * np.pi / count
    return _through(_stretched(rng.uniform(0.6, 1.2, count) * exp(1j * t), 2.0, rng))


def _rounded(rng: np.random.Generator) -> BodyCurve:
    """Return a polygon with corners cut repeatedly (Chaikin, CGIP 3 (1974) 346)."""
    ring = _polygon(rng)
    z, share = ring.points[list(ring.corners)], rng.uniform(0.06, 0.25)
    for k in range(6):
        cut = share if k == 0 else 0.25
        z = np.stack(
            [(1 - cut) * z + cut * np.roll(z, -1), cut * z + (1 - cut) * np.roll(z, -1)], axis=1
        ).ravel()
    return BodyCurve(_even_steps(z))


def _through(corners: Complexes) -> BodyCurve:
    """Return a closed curve through points (k,); those that turn by more than `BEND` are its corners."""
    edges = np.roll(corners, -1) - corners
    share = np.maximum(np.round(FINE * modulus(edges) / modulus(edges).sum()).astype(int), 1)
    z = np.concatenate([a + e * np.arange(n) / n for a, e, n in zip(corners, edges, share, strict=True)])
    turn = np.abs(angle(edges / np.roll(edges, 1)))
    first = np.concatenate([[0], np.cumsum(share)[:-1]])
    return BodyCurve(z, tuple(int(k) for k in first[turn > BEND]))


def _even_steps(z: Complexes) -> Complexes:
    closed = np.append(z, z[0])
    length = arc_lengths(closed)
    return at_lengths(closed, length, np.linspace(0.0, length[-1], FINE, endpoint=False))


def arc_lengths(z: Complexes) -> Floats:
    """Return the arc lengths (n,), from 0, at the points `z` (n,) of a polygon."""
    return np.concatenate([[0.0], np.cumsum(modulus(np.diff(z)))])


def at_lengths(z: Complexes, length: Floats, at: Floats) -> Complexes:
    """Return points (m,) at arc lengths `at` (m,) of a polygon; points `z` (n,) are at `length` (n,)."""
    return np.interp(at, length, z.real) + 1j * np.interp(at, length, z.imag)
