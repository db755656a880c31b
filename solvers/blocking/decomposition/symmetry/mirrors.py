"""The lines about which a domain is its own mirror image.

The image of the point of a loop at arc length s is the point of a loop at c - s, with a constant c.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, along_and_across, norms, turned_left
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop

SAME = 1e-7
"""Largest distance of a symmetric boundary from its mirror image, over the extent; drawings have 1e-12."""
MOST = 64  # largest number of directions that are examined; a circle has one for each of its points
MOST_MIRRORS = 8  # largest number of mirrors through a centre: a domain with more is a circle, or nearly
_STEPS = 8  # of Newton's method for the nearest point of a curve


@dataclass(frozen=True, eq=False)
class Mirror:
    """A mirror line through `centre` (2,) along the unit vector `along` (2,).

    It maps boundary loop k to loop `loops[k]`, and the arc length s on loop k to `sums[k]` - s.
    """

    centre: Floats
    along: Floats
    loops: Indices
    sums: Floats

    def images(self, points: Floats) -> Floats:
        """Return the mirror images of points (..., 2)."""
        return _images(points, self.centre, self.along)

    def ahead_and_left(self, points: Floats) -> tuple[Floats, Floats]:
        """Return two coordinates (...) of points (..., 2): along the line from `centre`, and to its left."""
        return along_and_across(points - self.centre, self.along)


@lru_cache(maxsize=64)
def mirrors_of(domain: Domain) -> tuple[Mirror, ...]:
    """Return the mirror lines of a domain, sorted by angle; the angles between neighbours are equal.

    The first mirror is along x or y if there is such a mirror. A circle counts as having four mirrors, a
    domain with periodic sides none.
    """
    if domain.periodic:
        return ()
    middles, centre = _centroids(domain)
    ways = _directions(domain, middles, centre)
    counts = (4, 2) if len(ways) > 2 * MOST_MIRRORS + 1 else range(MOST_MIRRORS, 1, -1)
    for along in ways:
        for way in (along, turned_left(along)):
            first = mirror_about(domain, centre, way)
            if first:
                several = (_all_about(domain, first, count) for count in counts)
                return next(filter(None, several), (first,))
    return ()


def _all_about(domain: Domain, first: Mirror, count: int) -> tuple[Mirror, ...]:
    """Return `count` mirrors at equal angles from the first one; none if the domain lacks one of them."""
    across, mirrors = turned_left(first.along), [first]
    for k in range(1, count):
        angle = math.pi * k / count
        cosine = 0.0 if 2 * k == count else math.cos(angle)
        mirror = mirror_about(domain, first.centre, cosine * first.along + math.sin(angle) * across)
        if mirror is None:
            return ()
        mirrors.append(mirror)
    return tuple(mirrors)


def mirror_about(domain: Domain, centre: Floats, along: Floats) -> Mirror | None:
    """Return the mirror along a line through `centre`; None if the domain is not symmetric about it."""
    middles, _ = _centroids(domain)
    apart = norms(_images(middles, centre, along)[:, None] - middles)
    apart[0, 1:] = apart[1:, 0] = np.inf  # the outer loop is its own image
    loops, near = apart.argmin(axis=1), SAME * domain.extent
    sums = []
    for loop, number in zip(domain.loops, loops.tolist(), strict=True):
        total = _sum_of_arcs(loop, domain.loops[number], centre, along, near)
        if total is None:
            return None
        sums.append(total)
    mirror = Mirror(centre, along, loops, np.array(sums))
    return mirror if _keeps_given(domain, mirror) else None


def _keeps_given(domain: Domain, mirror: Mirror) -> bool:
    """Return whether stretches of a domain and their images have the same prescribed values."""
    given: tuple[Mapping[str, float], ...] = (domain.heights, domain.counts)
    if not any(given):
        return True
    for loop, number, total in zip(domain.loops, mirror.loops.tolist(), mirror.sums.tolist(), strict=True):
        ends = np.append(loop.corner_arcs, loop.length + loop.corner_arcs[:1])
        middles = 0.5 * (ends[1:] + ends[:-1]) if loop.corners else np.zeros(1)
        for arc in middles.tolist():
            names = loop.name_at(arc), domain.loops[number].name_at(total - arc)
            if any(len({values[name] for name in names if name in values}) > 1 for values in given):
                return False
    return True


def _images(points: Floats, centre: Floats, along: Floats) -> Floats:
    ahead, left = along_and_across(points - centre, along)
    image = np.stack([ahead * along[0] + left * along[1], ahead * along[1] - left * along[0]], axis=-1)
    return np.asarray(centre + image)


def _centroids(domain: Domain) -> tuple[Floats, Floats]:
    """Return the centroids of the areas inside each loop (loops, 2), and of the domain (2,)."""
    start, moments = domain.loops[0].curve.points[0], []
    for loop in domain.loops:
        here = loop.curve.points - start
        there = np.roll(here, -1, axis=0)
        cross = here[:, 0] * there[:, 1] - there[:, 0] * here[:, 1]
        moments.append([cross.sum() / 2.0, *((here + there) * cross[:, None]).sum(axis=0) / 6.0])
    area, first = np.array(moments)[:, :1], np.array(moments)[:, 1:]
    return start + first / area, start + first.sum(axis=0) / area.sum()


def _directions(domain: Domain, middles: Floats, centre: Floats) -> list[Floats]:
    """Return possible directions of mirrors: first that of x, then those that pair up loops and corners.

    They take the first corner (or point) of a loop around the centroid to one as far from the centroid, and
    the centroids of holes to each other. The loop is that with the fewest corners.
    """
    near = SAME * domain.extent
    around = [
        loop for loop, middle in zip(domain.loops, middles, strict=True)
        if loop is domain.loops[0] or norms(middle - centre) <= near
    ]  # fmt: skip
    ends = min((loop.curve.points[list(loop.corners) or slice(None)] for loop in around), key=len)
    arms = ends - centre
    arms = arms[np.abs(norms(arms) - norms(arms[0])) <= near]
    sums, steps = arms[0] + arms, arms[0] - arms
    ways = np.where((norms(sums) > norms(steps))[:, None], sums, turned_left(steps))
    ways /= norms(ways)[:, None]
    fits = [
        way for way in ways
        if (norms(_images(middles, centre, way)[:, None] - middles).min(axis=1) <= near).all()
    ]  # fmt: skip
    return [np.array([1.0, 0.0]), *fits[:MOST]]


def _sum_of_arcs(loop: Loop, other: Loop, centre: Floats, along: Floats, near: float) -> float | None:
    """Return c if images of points at arc lengths s of a loop are at c - s on the other one, else None."""
    if abs(loop.length - other.length) > near or len(loop.corners) != len(other.corners):
        return None
    begin = loop.corner_arcs[0] if loop.corners else 0.0
    total = begin + _nearest(other, _images(loop.at(np.array([begin])), centre, along)[0])
    for one, two in ((loop, other), (other, loop)):
        arcs = _samples(one)
        if norms(_images(one.at(arcs), centre, along) - two.at(total - arcs)).max() > near:
            return None
    for arc, cells in zip(loop.corner_arcs, loop.corner_cells, strict=True):
        off = total - arc - other.corner_arcs
        off = np.abs(off - other.length * np.round(off / other.length))
        if off.min() > near or other.corner_cells[off.argmin()] != cells:
            return None
    return float(np.mod(total, other.length))


def _samples(loop: Loop) -> Floats:
    """Return the arc lengths of the points of a loop, then those of the middles between them."""
    knots = np.append(loop.curve.knots, loop.length)
    return np.concatenate([knots[:-1], 0.5 * (knots[1:] + knots[:-1])])


def _nearest(loop: Loop, point: Floats) -> float:
    """Return the arc length of the point of a loop nearest to a given point (2,)."""
    arcs = _samples(loop)
    arc = arcs[norms(loop.at(arcs) - point).argmin()][None]
    for _ in range(_STEPS):
        arc = arc + ((point - loop.at(arc)) * loop.tangent(arc)).sum(axis=1)
    return float(arc[0])
