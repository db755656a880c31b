"""Coordinate lines of a seamless map as pieces in triangles; points on the lines by arc length."""

from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats, Indices, complex_of
from meshonet.geometry.elementary import modulus, times
from meshonet.geometry.errors import SolverError
from meshonet.solvers.blocking.decomposition.field.seamless_map import SeamlessMap

Tables = tuple[Floats, Indices, Indices, Indices]


def map_tables(seamless: SeamlessMap) -> Tables:
    """Return the map as arrays for compiled code."""
    coords = np.ascontiguousarray(seamless.corner_coords).view(np.float64).reshape(-1, 3, 2)
    return coords, seamless.surface.neighbours, seamless.surface.neighbour_edge, seamless.turns


@dataclass(frozen=True, eq=False)
class Trails:
    """Lines of constant u or v in a map of a triangulation to a plane u, v; straight in each triangle."""

    first: Indices  # (k + 1,) first piece of each trail
    face: Indices  # (p,) triangle of the piece
    edge: Indices  # (p,) edge of the triangle that contains the piece, at walls; -1 elsewhere
    length: Floats  # (p + k,) length in the map at the start of each piece, and at the end of a trail
    begin: Complexes  # (p,) start in the plane
    end: Complexes  # (p,) end in the plane
    loop: Indices  # (k,) number of the loop, for walls; -1 for rays
    arc: Floats  # (p, 2) arc length on the loop at the start of the piece, and length of it; 0 for rays
    vertex: Indices  # (p,) vertex at the start of the piece, at walls; -1 elsewhere

    def total(self, trail: int) -> float:
        """Return the length of line number `trail` in the plane u, v to which the triangulation is mapped."""
        return float(self.length[self.first[trail + 1] + trail])

    def at_vertex(self, vertex: int) -> tuple[int, float]:
        """Return the index of the boundary line through a vertex, and the line's length up to the vertex.

        Lengths are measured in the plane u, v to which the triangulation is mapped.
        """
        return self._on_piece(self.vertex == vertex, 0.0)

    def at_edge(self, face: int, edge: int, part: float) -> tuple[int, float]:
        """Return the boundary line (index) along an edge, and its length up to a point of the edge.

        The point is at the fraction `part` of edge number `edge` of triangle `face`. Lengths are measured in
        the plane u, v to which the triangulation is mapped.
        """
        return self._on_piece((self.face == face) & (self.edge == edge), part)

    def _on_piece(self, which: Bools, part: float) -> tuple[int, float]:
        piece = int(np.argmax(which))
        trail = int(np.searchsorted(self.first, piece, side="right")) - 1
        start, stop = self.length[piece + trail : piece + trail + 2]
        return trail, float(start + part * (stop - start))

    def locate(self, trail: Indices, length: Floats) -> tuple[Indices, Floats]:
        """Return, for points on lines, the index of the piece of line (q,), and the place on it from 0 to 1.

        Each piece is straight, in one triangle. `trail` (q,) are the indices of the points' lines, `length`
        (q,) the lengths of these lines up to the points.
        """
        ends = self.length[self.first[1:] + np.arange(len(self.first) - 1)]
        offset = np.append(0.0, np.cumsum(ends))
        owner = np.repeat(np.arange(len(ends)), np.diff(self.first))
        index = np.arange(len(self.face)) + owner
        start, stop = self.length[index], self.length[index + 1]
        piece = np.searchsorted(start + offset[owner], length + offset[trail], side="right") - 1
        piece = np.clip(piece, self.first[trail], self.first[trail + 1] - 1)
        span = stop[piece] - start[piece]
        part = np.divide(length - start[piece], span, out=np.zeros(len(piece)), where=span > 0)
        return piece, np.clip(part, 0.0, 1.0)

    def joined(self, others: "Trails") -> "Trails":
        """Return these lines and, after them, the lines of `others`."""
        names = [each.name for each in fields(self)]
        mine, theirs = ([getattr(trails, name) for name in names] for trails in (self, others))
        theirs[0] = theirs[0][1:] + self.first[-1]
        return Trails(*(np.concatenate(pair) for pair in zip(mine, theirs, strict=True)))


def ray_trails(seamless: SeamlessMap, pieces: Indices, lines: Floats, count: int) -> Trails:
    """Return `count` lines of constant u or v of a map, joined from p pieces, each straight in a triangle.

    `pieces` (p, 3) has the index of the line and of the triangle of each piece. `lines` (p, 5) has u and v of
    the start of the piece, u and v of its end, and the length of the line before it.
    """
    order = np.argsort(pieces[:, 0], kind="stable")
    pieces, lines = pieces[order], lines[order]
    many = np.bincount(pieces[:, 0], minlength=count)
    first = np.append(0, np.cumsum(many)).astype(np.intp)
    origin, stop = complex_of(lines[:, :2]), complex_of(lines[:, 2:4])
    face = pieces[:, 1]
    length = np.insert(lines[:, 4], first[1:], 0.0) if count else np.zeros(0)
    last = first[1:] - 1
    ran = np.flatnonzero(many)
    length[(first[1:] + np.arange(count))[ran]] = (lines[:, 4] + modulus(stop - origin))[last[ran]]
    return Trails(
        first=first,
        face=face,
        edge=np.full(len(face), -1, dtype=np.intp),
        length=length,
        begin=to_plane(seamless, face, origin),
        end=to_plane(seamless, face, stop),
        loop=np.full(count, -1, dtype=np.intp),
        arc=np.zeros((len(face), 2)),
        vertex=np.full(len(face), -1, dtype=np.intp),
    )


def wall_trails(seamless: SeamlessMap) -> Trails:
    """Return trails (lines in the map) along the walls, outer loop first, with the domain on the left."""
    triangulation = seamless.surface
    faces, edges = triangulation.walls
    start = triangulation.triangles[faces, edges]
    follow = dict(zip(start.tolist(), zip(faces.tolist(), edges.tolist(), strict=True), strict=True))
    order: list[tuple[int, int]] = []
    first = [0]
    for vertex in sorted(follow):
        at = vertex
        while at in follow:
            f, e = follow.pop(at)
            order.append((f, e))
            at = int(triangulation.triangles[f, (e + 1) % 3])
        if len(order) > first[-1]:
            if at != vertex:
                raise SolverError("a wall of the triangulation is not closed")
            first.append(len(order))
    face, edge = (np.array(column, dtype=np.intp) for column in zip(*order, strict=True))
    here = triangulation.triangles[face, edge]
    there = triangulation.triangles[face, (edge + 1) % 3]
    step = modulus(seamless.corner_coords[face, (edge + 1) % 3] - seamless.corner_coords[face, edge])
    runs = [np.append(0.0, np.cumsum(step[a:b])) for a, b in pairwise(first)]
    loops = triangulation.loop[here[first[:-1]]]
    whole = triangulation.domain.lengths[triangulation.loop[here]]
    arc = triangulation.arc[here]
    plane = complex_of(triangulation.points)
    return Trails(
        first=np.array(first, dtype=np.intp),
        face=face,
        edge=edge,
        length=np.concatenate(runs),
        begin=plane[here],
        end=plane[there],
        loop=np.asarray(loops, dtype=np.intp),
        arc=np.stack([arc, np.mod(triangulation.arc[there] - arc, whole)], axis=1),
        vertex=here,
    )


def to_plane(seamless: SeamlessMap, face: Indices, w: Complexes) -> Complexes:
    """Return the points (q,), complex numbers, at map coordinates `w` (q,) in the triangles `face` (q,)."""
    corners = seamless.corner_coords[face]
    a, b, q = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0], w - corners[:, 0]
    size = times(a.conj(), b).imag
    s, r = times(q.conj(), b).imag / size, times(a.conj(), q).imag / size
    z = complex_of(seamless.surface.points[seamless.surface.triangles[face]])
    return np.asarray(z[:, 0] * (1 - s - r) + z[:, 1] * s + z[:, 2] * r)
