"""One part of a symmetric domain, between mirror lines; the mesh of this part and of its images.

It is the half on the left of a mirror, a quarter between two mirrors at right angles, or a sector from a
mirror to the next but one. The sides of the part on mirrors become grid lines of the mesh.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, along_and_across, distinct, norms, shortest_ways
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.kernels._native import nearest_points
from meshonet.solvers.blocking.decomposition.quads.padding import Span
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror

_NEAR = 1e-6  # positions nearer than this fraction of a loop, or of the extent, are the same
_SHARPEST = 52.5  # degrees, of half a corner: a corner of 90 degrees is not cut, one of 120 degrees is
Ray = tuple[Mirror, Floats]  # a mirror, and the direction (2,) of the ray on it, from the centre of the part


@dataclass(frozen=True, eq=False)
class LoopPart:
    """A piece of the outline of one part of a symmetric domain: along a loop, or where mirror lines meet."""

    loop: int  # index of the boundary loop; -1 for the point where mirror lines meet
    arcs: Floats  # (n,) ascending arc lengths
    points: Floats  # (n, 2) points at these arc lengths
    corners: Indices  # indices of the points that are corners, including those on mirror lines
    breaks: Indices  # indices of the points at which the tangent may jump
    straight: Bools
    """(n,) whether the outline is straight up to the next point; from the last point it follows a mirror."""


@dataclass(frozen=True, eq=False)
class DomainPart:
    """A part of a symmetric domain, from which mirror images make the whole.

    Parameters
    ----------
    whole : the whole domain.
    domain : the part as a domain; its outer loop begins on the first of `rays`.
    stretches : parts of loops of the whole domain that bound the part.
    holes : indices of the loops of the whole domain inside the part.
    rays : the mirrors that bound the part.
    copies : for each copy, the mirrors in which it is reflected, in order; none for the part itself.
    """

    whole: Domain
    domain: Domain
    stretches: tuple[LoopPart, ...]
    holes: tuple[int, ...]
    rays: tuple[Mirror, ...]
    copies: tuple[tuple[Mirror, ...], ...]


def spans_between(loop: Loop) -> list[Span]:
    """Return the parts of the outer loop that begin and end at corners with a single cell.

    All corners in between have two cells. A part is (0, begin, end): the index 0 of the outer loop, and
    the arc lengths at which the part begins and ends.
    """
    corners = zip(loop.corner_arcs.tolist(), loop.corner_cells.tolist(), strict=True)
    turns = [(arc, cells) for arc, cells in corners if cells != 2]
    pairs = pairwise([*turns, *((arc + loop.length, cells) for arc, cells in turns[:1])])
    return [(0, begin, end) for (begin, first), (end, last) in pairs if first == last == 1]


def part_of(domain: Domain, mirrors: Sequence[Mirror]) -> DomainPart:
    """Return the half of a domain to the left of a mirror, or the quarter to the left of two mirrors.

    Two mirrors must be perpendicular. Raises SolverError if a mirror cuts a sharp corner.
    """
    first, *others = mirrors
    if others:
        copies = (), (others[0],), (first,), (others[0], first)
        return _between(domain, (others[0], others[0].along), (first, -first.along), first.centre, copies)
    own = (k for k in range(len(domain.loops)) if first.loops[k] == k)
    crossed = [first.ahead_and_left(_on_mirror(domain.loops[k], k, first)[1])[0] for k in own]
    centre = first.centre + np.sort(np.concatenate(crossed))[:2].mean() * first.along  # inside, before holes
    return _between(domain, (first, first.along), (first, -first.along), centre, ((), (first,)))


def sector_of(domain: Domain, mirrors: Sequence[Mirror], start: int) -> DomainPart:
    """Return a sector of a domain; copies of the sector, rotated about the centre, make up the domain.

    It reaches from mirror line `start` to the next but one in `mirrors`, which are sorted by angle. Raises
    SolverError if a mirror cuts a sharp corner, or if the mirrors meet outside the domain.
    """
    count = len(mirrors)
    first, middle, last = (mirrors[k % count] for k in range(start, start + 3))
    ways = [mirror.along if k < count else -mirror.along for k, mirror in ((start, first), (start + 2, last))]
    copies = tuple((first, middle) * k for k in range(count))
    return _between(domain, (first, ways[0]), (last, ways[1]), mirrors[0].centre, copies)


def _between(
    domain: Domain, first: Ray, last: Ray, centre: Floats, copies: tuple[tuple[Mirror, ...], ...]
) -> DomainPart:
    """Return the part to the left of one ray and to the right of another one."""
    through, holes = [], []
    on_rays: tuple[list[LoopPart], list[LoopPart]] = ([], [])
    for number, loop in enumerate(domain.loops):
        crossed = [_crossings(loop, number, mirror, way, centre) for mirror, way in (first, last)]
        if all(len(each) == 1 for each in crossed):  # around the centre; a hole leads back to the first ray
            ends = crossed if number == 0 else crossed[::-1]
            mirrors = (first[0], last[0]) if number == 0 else (last[0], first[0])
            through.append(_stretch(loop, number, ends[0][0], loop.length / len(copies), mirrors))
        for own, arcs, (mirror, way), side in zip(on_rays, crossed, (first, last), (1.0, -1.0), strict=True):
            if len(arcs) == 2:
                own.append(_half(loop, number, mirror, side * way))
        place = loop.curve.points[0] - centre
        if (
            not any(crossed)
            and along_and_across(place, first[1])[1] > 0.0 > along_and_across(place, last[1])[1]
        ):
            holes.append(number)
    if not through or through[0].loop != 0:
        raise SolverError("an outer loop that is not around the centre of mirrors")
    outer, *inner = through
    before, behind = (sorted(own, key=lambda part: float(norms(part.points[0] - centre))) for own in on_rays)
    if not inner and first[0] is not last[0]:
        one = np.zeros(1, dtype=np.intp)
        inner = [LoopPart(-1, np.zeros(1), centre[None], one, one, np.ones(1, dtype=bool))]
    row = (outer, *behind[::-1], *inner, *before)
    part = Domain((_joined(row), *(domain.loops[k] for k in holes)), domain.name)
    rays = (first[0],) if first[0] is last[0] else (first[0], last[0])
    return DomainPart(domain, part, row, tuple(holes), rays, copies)


def _crossings(loop: Loop, number: int, mirror: Mirror, way: Floats, centre: Floats) -> list[float]:
    """Return the arc lengths at which a loop crosses a ray from the centre."""
    if mirror.loops[number] != number:
        return []
    arcs, points = _on_mirror(loop, number, mirror)
    ahead = along_and_across(points - centre, way)[0]
    return [float(arc) for arc, far in zip(arcs, ahead, strict=True) if far > 0.0]


def _on_mirror(loop: Loop, number: int, mirror: Mirror) -> tuple[Floats, Floats]:
    """Return the two arc lengths (2,) at which a loop crosses its mirror, and the points (2, 2) there."""
    arcs = 0.5 * mirror.sums[number] + np.array([0.0, 0.5 * loop.length])
    return arcs, loop.at(arcs)


def _joined(row: Sequence[LoopPart]) -> Loop:
    """Return the loop along stretches and lines between. Raises SolverError: a ray cuts a sharp corner."""
    counts = [len(stretch.points) for stretch in row]
    first = np.cumsum([0, *counts[:-1]])
    corners = np.concatenate([k + stretch.corners for k, stretch in zip(first, row, strict=True)])
    breaks = np.concatenate([k + stretch.breaks for k, stretch in zip(first, row, strict=True)])
    points = np.concatenate([stretch.points for stretch in row])
    straight = np.concatenate([stretch.straight for stretch in row])
    curve = Curve(points, closed=True, corners=breaks, straight=straight)
    loop = Loop(curve, tuple(corners.tolist()), ("half",))
    on_wall = np.array([stretch.loop >= 0 for stretch in row])
    ends = np.isin(corners, [first[on_wall], (first + counts - 1)[on_wall]])
    if (loop.corner_angles[ends] < _SHARPEST).any():
        raise SolverError("a mirror through a sharp corner")
    return loop


def _half(loop: Loop, number: int, mirror: Mirror, way: Floats) -> LoopPart:
    """Return the half of a loop that crosses a mirror on the left of it, seen in the direction `way` (2,)."""
    half, begin = 0.5 * loop.length, 0.5 * mirror.sums[number]
    if along_and_across(loop.at(begin + 0.5 * half) - mirror.centre, way)[1] < 0.0:
        begin += half
    return _stretch(loop, number, begin, half, (mirror, mirror))


def _stretch(
    loop: Loop, number: int, begin: float, length: float, mirrors: tuple[Mirror, Mirror]
) -> LoopPart:
    """Return the stretch of a loop that starts at arc length `begin`; its ends are moved onto `mirrors`."""
    near = _NEAR * loop.length
    knots = np.append(loop.curve.knots, loop.length)
    along, corners, breaks = (
        np.concatenate([[0.0], inner[(inner > near) & (inner < length - near)], [length]])
        for inner in (
            distinct(np.mod(arcs - begin, loop.length))
            for arcs in (
                np.append(knots, 0.5 * (knots[1:] + knots[:-1])),
                loop.corner_arcs,
                loop.curve.corners,
            )
        )
    )
    straight = np.zeros(len(knots) - 1, dtype=bool) if loop.curve.straight is None else loop.curve.straight
    middles = np.mod(begin + 0.5 * (along[1:] + along[:-1]), loop.length)
    straight = straight[np.searchsorted(knots, middles, side="right") - 1]
    points = loop.at(begin + along)
    for end, mirror in zip((0, -1), mirrors, strict=True):
        points[end] = 0.5 * (points[end] + mirror.images(points[end]))
    corners, breaks = (np.searchsorted(along, arcs - near) for arcs in (corners, breaks))
    return LoopPart(number, begin + along, points, corners, breaks, np.append(straight, True))


def with_copies(mesh: QuadMesh, part: DomainPart) -> QuadMesh:
    """Return a mesh of the whole domain, copied from that of a part; nodes at mirror lines may not match."""
    nodes, (loop, arc, on_ray) = mesh.nodes.copy(), _places_in_whole(mesh, part)
    ends = np.flatnonzero(on_ray)
    nearest = np.stack([np.abs(ray.ahead_and_left(nodes[ends])[1]) for ray in part.rays]).argmin(axis=0)
    for k, ray in enumerate(part.rays):
        own = ends[nearest == k]
        nodes[own] = 0.5 * (nodes[own] + ray.images(nodes[own]))
    copies, quads, count = list[tuple[Floats, Indices, Floats]](), list[Indices](), 0
    known, numbers, near = np.empty((0, 2)), np.empty(0, dtype=np.intp), _NEAR * part.whole.extent
    for mirrors in part.copies:
        now, own_loop, own_arc = nodes, loop, arc
        table = np.full(len(nodes), -1, dtype=np.intp)
        for mirror in mirrors:
            on, now = own_loop >= 0, mirror.images(now)
            own_arc = np.where(on, mirror.sums[own_loop] - own_arc, 0.0)
            own_loop = np.where(on, mirror.loops[own_loop], -1)
        if count:
            same, squares = nearest_points(np.ascontiguousarray(now[ends]), known)
            table[ends] = np.where(squares < near**2, numbers[same], -1)
        new = np.flatnonzero(table < 0)
        table[new] = count + np.arange(len(new))
        count += len(new)
        copies.append((now[new], own_loop[new], own_arc[new]))
        fresh = ends[np.isin(ends, new)]
        known, numbers = np.concatenate([known, now[fresh]]), np.append(numbers, table[fresh])
        quads.append(table[mesh.quads[:, :: -1 if len(mirrors) % 2 else 1]])
    points, loops, arcs = (np.concatenate(each) for each in zip(*copies, strict=True))
    places = replace(Places.inside(count), loop=loops, arc=arcs)
    return _on_loops(QuadMesh(part.whole, points, np.concatenate(quads), places), numbers)


def _on_loops(mesh: QuadMesh, on_rays: Indices) -> QuadMesh:
    """Return a mesh of copies of a part with its wall nodes on the loops, the nearest ones at corners.

    Corners among `on_rays` (k,) that should have an odd number of cells get the number that they have.
    """
    whole, points, places = mesh.domain, mesh.nodes.copy(), mesh.places
    loop, arc, cells = places.loop, places.arc.copy(), np.zeros_like(places.cells)
    for number, each in enumerate(whole.loops):
        walls = np.flatnonzero(loop == number)
        arcs = np.mod(arc[walls], each.length)
        for corner, wanted in zip(each.corner_arcs, each.corner_cells, strict=True):
            off = np.abs(shortest_ways(arcs - corner, each.length))
            at = off.argmin()
            arcs[at], cells[walls[at]] = corner, wanted
        arc[walls], points[walls] = arcs, each.at(arcs)
    odd = on_rays[cells[on_rays] % 2 == 1]
    cells[odd] = mesh.valence[odd]
    return QuadMesh(whole, points, mesh.quads, replace(places, arc=arc, cells=cells))


def _places_in_whole(mesh: QuadMesh, part: DomainPart) -> tuple[Indices, Floats, Bools]:
    """Return loops (n,) and arc lengths (n,) of a part's nodes in the whole, and whether (n,) on rays."""
    old, outer = mesh.places, mesh.domain.loops[0]
    loop, arc = np.full(len(old.loop), -1, dtype=np.intp), np.zeros(len(old.loop))
    on_ray, near, first = old.loop == 0, _NEAR * outer.length, 0
    for stretch in part.stretches:
        knots = outer.curve.knots[first : first + len(stretch.arcs)]
        first += len(knots)
        if stretch.loop < 0:
            continue
        on = (old.loop == 0) & (old.arc >= knots[0] - near) & (old.arc <= knots[-1] + near)
        loop[on], arc[on] = stretch.loop, np.interp(old.arc[on], knots, stretch.arcs)
        on_ray &= ~on | (old.arc <= knots[0] + near) | (old.arc >= knots[-1] - near)
    for number, hole in enumerate(part.holes, start=1):
        on = old.loop == number
        loop[on], arc[on] = hole, old.arc[on]
    return loop, arc, on_ray
