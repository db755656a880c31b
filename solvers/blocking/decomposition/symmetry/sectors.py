"""One sector of a domain with three or more mirrors through a centre, and the mesh of all sectors.

A sector reaches from a mirror to the next but one. It is symmetric to the mirror between; so the nodes on its
two rays are each other's images, and turned copies of it fit together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, along_and_across, norms
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.solvers.blocking.decomposition.errors import BlockingError
from meshonet.solvers.blocking.decomposition.symmetry.halves import (
    LoopPart,
    half_of,
    joined,
    on_loops,
    places_in_whole,
    stretch_of,
)
from meshonet.solvers.blocking.decomposition.symmetry.images import images_of
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror, mirror_about

_NEAR = 1e-6
"""Part of the extent within which a node is at the centre."""


@dataclass(frozen=True, eq=False)
class Sector:
    """A sector of a domain.

    Parameters
    ----------
    whole : the domain.
    domain : the sector; its outer loop begins on the first ray.
    stretches, holes : its walls: stretches of loops of the whole, and loops inside it.
    rays : mirrors on its first ray, in the middle and on its last ray.
    count : how many sectors there are.
    """

    whole: Domain
    domain: Domain
    stretches: tuple[LoopPart, ...]
    holes: tuple[int, ...]
    rays: tuple[Mirror, Mirror, Mirror]
    count: int


def sector_of(domain: Domain, mirrors: Sequence[Mirror], start: int) -> Sector:
    """Return the sector that begins at mirror number `start` of all mirrors, by their angles.

    Raises BlockingError: a ray cuts a sharp corner, or the centre is outside.
    """
    count = len(mirrors)
    rays = [mirrors[k % count] for k in (start, start + 1, start + 2)]
    ways = [mirror.along * _forward(mirrors[0], mirror) for mirror in rays]
    ways = [way if start + k < count else -way for k, way in enumerate(ways)]
    ends = (rays[0], ways[0]), (rays[2], ways[2])
    through, holes = [], []
    on_rays: tuple[list[LoopPart], list[LoopPart]] = ([], [])
    for number, loop in enumerate(domain.loops):
        crossed = [_crossings(domain, number, *each) for each in ends]
        if all(len(each) == 1 for each in crossed):
            through.append(_between(loop, number, crossed, (rays[0], rays[2])))
        for own, arcs, end, side in zip(on_rays, crossed, ends, (1.0, -1.0), strict=True):
            if len(arcs) == 2:
                own.append(half_of(loop, number, end[0], side * end[1]))
        place = loop.curve.points[0] - mirrors[0].centre
        left = [float(along_and_across(place, way)[1]) for _, way in ends]
        if not any(crossed) and left[0] > 0.0 > left[1]:
            holes.append(number)
    if not through or through[0].loop != 0:
        raise BlockingError("an outer loop that is not around the centre of mirrors")
    outer, *inner = through
    centre = mirrors[0].centre
    first, last = (sorted(own, key=lambda part: float(norms(part.points[0] - centre))) for own in on_rays)
    row = (outer, *last[::-1], *(inner or [_centre(centre)]), *first)
    part = Domain((joined(row), *(domain.loops[k] for k in holes)), domain.name)
    return Sector(domain, part, row, tuple(holes), (rays[0], rays[1], rays[2]), count)


def _between(loop: Loop, number: int, crossed: list[list[float]], rays: tuple[Mirror, Mirror]) -> LoopPart:
    """Return the stretch of a loop around the centre in a sector: a hole runs back to the first ray."""
    (begin,), (end,) = crossed if number == 0 else crossed[::-1]
    return stretch_of(loop, number, begin, (end - begin) % loop.length, rays if number == 0 else rays[::-1])


def _forward(first: Mirror, mirror: Mirror) -> float:
    """Return 1 if a mirror's direction is within half a turn to the left of the first one's, else -1."""
    left = float(along_and_across(mirror.along, first.along)[1])
    return 1.0 if mirror is first or left > 0.0 else -1.0


def _centre(centre: Floats) -> LoopPart:
    one = np.zeros(1, dtype=np.intp)
    return LoopPart(-1, np.zeros(1), centre[None], one, one, np.ones(1, dtype=bool))


def _crossings(domain: Domain, number: int, mirror: Mirror, way: Floats) -> list[float]:
    """Return the arc lengths at which a loop crosses a ray from the centre."""
    if mirror.loops[number] != number:
        return []
    loop = domain.loops[number]
    arcs = 0.5 * mirror.sums[number] + np.array([0.0, 0.5 * loop.length])
    ahead = along_and_across(loop.at(arcs) - mirror.centre, way)[0]
    return [float(arc) for arc, far in zip(arcs, ahead, strict=True) if far > 0.0]


def all_sectors(mesh: QuadMesh, sector: Sector) -> QuadMesh:
    """Return the mesh of the whole domain from that of a sector, whose quads are symmetric.

    Raises BlockingError: they are not.
    """
    first, between, _ = sector.rays
    own = mirror_about(mesh.domain, between.centre, between.along)
    images = images_of(mesh, [own] if own else [])
    if not images:
        raise BlockingError("a sector without a symmetric mesh")
    image, count = images[0][1], sector.count
    loop, arc, on_ray = places_in_whole(mesh, sector.stretches, sector.holes)
    at_centre, on_first, on_last = _on_rays(mesh.nodes, on_ray, sector)
    if not np.array_equal(np.sort(image[on_first]), np.flatnonzero(on_last)):
        raise BlockingError("rays of a sector that differ")
    nodes = mesh.nodes.copy()
    nodes[on_first] = 0.5 * (nodes[on_first] + first.images(nodes[on_first]))
    kept = np.flatnonzero(~on_last & ~at_centre)
    step, middle = len(kept), np.flatnonzero(at_centre)
    place = np.full(len(nodes), count * step)  # which is the centre's number
    place[kept] = np.arange(step)
    tables = []
    for k in range(count):
        table = np.where(at_centre, place, place + k * step)
        table[on_last] = place[image[on_last]] + (k + 1) % count * step
        tables.append(table)
    copies = [(nodes[kept], loop[kept], arc[kept])]
    for _ in range(1, count):
        copies.append(_image(_image(copies[-1], first), between))
    copies.append((np.tile(between.centre, (len(middle), 1)), loop[middle], arc[middle]))
    points, loops, arcs = (np.concatenate(each) for each in zip(*copies, strict=True))
    places = replace(Places.inside(len(loops)), loop=loops, arc=arcs)
    quads = np.concatenate([table[mesh.quads] for table in tables])
    rays = np.concatenate([*[on_first[kept]] * count, np.ones(len(middle), dtype=bool)])
    return on_loops(QuadMesh(sector.whole, points, quads, places), rays)


def _on_rays(nodes: Floats, on_ray: Bools, sector: Sector) -> tuple[Bools, Bools, Bools]:
    """Return which nodes are at the centre, on the first ray and on the last one."""
    first, between, last = sector.rays
    off = [np.abs(mirror.ahead_and_left(nodes)[1]) for mirror in (first, last)]
    at_centre = on_ray & (norms(nodes - between.centre) < _NEAR * sector.whole.extent)
    on_last = on_ray & (off[1] < off[0]) & ~at_centre
    return at_centre, on_ray & ~on_last & ~at_centre, on_last


def _image(copy: tuple[Floats, Indices, Floats], mirror: Mirror) -> tuple[Floats, Indices, Floats]:
    """Return nodes, their loops and their arc lengths in a mirror."""
    nodes, loop, arc = copy
    on = loop >= 0
    return (
        mirror.images(nodes),
        np.where(on, mirror.loops[loop], -1),
        np.where(on, mirror.sums[loop] - arc, 0.0),
    )
