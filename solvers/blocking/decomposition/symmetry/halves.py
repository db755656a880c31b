"""One half of a symmetric domain, bounded by the mirror line, and the mesh of both halves.

The mirror line becomes a grid line of the mesh. A loop that crosses it meets it at right angles or at half a
corner. The number of cells there follows from the angle in each half, and is even in the whole domain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, along_and_across, distinct
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.solvers.blocking.decomposition.errors import BlockingError
from meshonet.solvers.blocking.decomposition.quads.padding import Span
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import Mirror

_NEAR = 1e-6
"""Part of a loop within which places are the same: more than images are off a boundary, less than a cell."""
_SHARPEST = 52.5
"""Degrees of half a corner, at the least: one of 90 degrees keeps its one cell, one of 120 is cut in two."""


@dataclass(frozen=True, eq=False)
class LoopPart:
    """Part of a loop of the whole: its arc lengths (n,), rising from mirror to mirror, and their points.

    The number of the loop is -1 for the centre, which is on none.
    """

    loop: int
    arcs: Floats
    points: Floats
    """(n, 2)"""
    corners: Indices
    """Which of them are corners, those on the mirror included."""
    breaks: Indices
    """At which its tangent may jump."""
    straight: Bools
    """(n,) whether the way to the next is straight, as it is from the last along the mirror."""


@dataclass(frozen=True, eq=False)
class Half:
    """The left half of a domain: `stretches` of its outer loop, and loops `holes` of the whole, are walls."""

    whole: Domain
    mirror: Mirror
    domain: Domain
    stretches: tuple[LoopPart, ...]
    holes: tuple[int, ...]


def spans_between(loop: Loop) -> list[Span]:
    """Return the stretches of the outer loop of a part from a corner of one cell to the next, two between.

    A row of quads along one takes singularities off the wall, or off the mirror.
    """
    corners = zip(loop.corner_arcs.tolist(), loop.corner_cells.tolist(), strict=True)
    turns = [(arc, cells) for arc, cells in corners if cells != 2]
    pairs = pairwise([*turns, *((arc + loop.length, cells) for arc, cells in turns[:1])])
    return [(0, begin, end) for (begin, first), (end, last) in pairs if first == last == 1]


def left_half(domain: Domain, mirror: Mirror) -> Half:
    """Return the half of a domain on the left of a mirror. Raises BlockingError: it cuts a sharp corner."""
    outer, *others = (
        half_of(loop, k, mirror, mirror.along) for k, loop in enumerate(domain.loops) if mirror.loops[k] == k
    )
    begin, end = (mirror.ahead_and_left(outer.points[k])[0] for k in (0, -1))
    way = 1.0 if begin > end else -1.0  # from the end of the outer half back to where it begins
    others.sort(key=lambda stretch: way * float(mirror.ahead_and_left(stretch.points[0])[0]))
    row = (outer, *others)
    loop = joined(row)
    left = [mirror.ahead_and_left(loop.curve.points[0])[1] > 0.0 for loop in domain.loops]
    holes = tuple(k for k in np.flatnonzero(left).tolist() if mirror.loops[k] != k)
    return Half(domain, mirror, Domain((loop, *(domain.loops[k] for k in holes)), domain.name), row, holes)


def joined(row: Sequence[LoopPart]) -> Loop:
    """Return the loop along stretches and straight lines between them.

    Raises BlockingError: a sharp corner at an end of one.
    """
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
        raise BlockingError("a mirror through a sharp corner")
    return loop


def half_of(loop: Loop, number: int, mirror: Mirror, way: Floats) -> LoopPart:
    """Return the half of a loop that crosses a mirror on the left of it, seen in the direction `way` (2,)."""
    half, begin = 0.5 * loop.length, 0.5 * mirror.sums[number]
    if along_and_across(loop.at(begin + 0.5 * half) - mirror.centre, way)[1] < 0.0:
        begin += half
    return stretch_of(loop, number, begin, half, (mirror, mirror))


def stretch_of(
    loop: Loop, number: int, begin: float, half: float, mirrors: tuple[Mirror, Mirror]
) -> LoopPart:
    """Return the stretch of a loop from an arc length on, of a length; it begins and ends on mirrors."""
    near = _NEAR * loop.length
    knots = np.append(loop.curve.knots, loop.length)
    along, corners, breaks = (
        np.concatenate([[0.0], inner[(inner > near) & (inner < half - near)], [half]])
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


def both_halves(mesh: QuadMesh, half: Half) -> QuadMesh:
    """Return the mesh of the whole domain from that of its left half and the mirror image."""
    whole, mirror = half.whole, half.mirror
    loop, arc, on_mirror = places_in_whole(mesh, half.stretches, half.holes)
    nodes = mesh.nodes.copy()
    nodes[on_mirror] = 0.5 * (nodes[on_mirror] + mirror.images(nodes[on_mirror]))
    added = np.flatnonzero(~on_mirror)
    to = np.arange(len(nodes))
    to[added] = len(nodes) + np.arange(len(added))
    on = loop[added] >= 0
    arc = np.append(arc, np.where(on, mirror.sums[loop[added]] - arc[added], 0.0))
    loop = np.append(loop, np.where(on, mirror.loops[loop[added]], -1))
    points = np.concatenate([nodes, mirror.images(nodes[added])])
    quads = np.concatenate([mesh.quads, to[mesh.quads[:, ::-1]]])
    return on_loops(
        QuadMesh(whole, points, quads, replace(Places.inside(len(loop)), loop=loop, arc=arc)), on_mirror
    )


def on_loops(mesh: QuadMesh, on_mirror: Bools) -> QuadMesh:
    """Return a mesh of copies of a part with its wall nodes on the loops of its domain, some at corners.

    The first nodes of it may lie `on_mirror` (k,): a corner there has as many cells as meet in it, if it was
    to have an odd number.
    """
    whole, points, places = mesh.domain, mesh.nodes.copy(), mesh.places
    loop, arc, cells = places.loop, places.arc.copy(), np.zeros_like(places.cells)
    for number, each in enumerate(whole.loops):
        walls = np.flatnonzero(loop == number)
        arcs = np.mod(arc[walls], each.length)
        for corner, wanted in zip(each.corner_arcs, each.corner_cells, strict=True):
            off = np.abs(np.mod(arcs - corner + 0.5 * each.length, each.length) - 0.5 * each.length)
            at = off.argmin()
            arcs[at], cells[walls[at]] = corner, wanted
        arc[walls], points[walls] = arcs, each.at(arcs)
    odd = np.flatnonzero(on_mirror & (cells[: len(on_mirror)] % 2 == 1))
    cells[odd] = np.bincount(mesh.quads.ravel(), minlength=len(loop))[odd]
    return QuadMesh(whole, points, mesh.quads, replace(places, arc=arc, cells=cells))


def places_in_whole(
    mesh: QuadMesh, stretches: Sequence[LoopPart], holes: Sequence[int]
) -> tuple[Indices, Floats, Bools]:
    """Return loop and arc length in the whole of the nodes of a part, and which lie on a mirror."""
    old, outer = mesh.places, mesh.domain.loops[0]
    loop, arc = np.full(len(old.loop), -1, dtype=np.intp), np.zeros(len(old.loop))
    on_mirror, near, first = old.loop == 0, _NEAR * outer.length, 0
    for stretch in stretches:
        knots = outer.curve.knots[first : first + len(stretch.arcs)]
        first += len(knots)
        if stretch.loop < 0:
            continue
        on = (old.loop == 0) & (old.arc >= knots[0] - near) & (old.arc <= knots[-1] + near)
        loop[on], arc[on] = stretch.loop, np.interp(old.arc[on], knots, stretch.arcs)
        on_mirror &= ~on | (old.arc <= knots[0] + near) | (old.arc >= knots[-1] - near)
    for number, hole in enumerate(holes, start=1):
        on = old.loop == number
        loop[on], arc[on] = hole, old.arc[on]
    return loop, arc, on_mirror
