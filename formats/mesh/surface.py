"""Boundaries from unstructured meshes and drawings: closed curves of named edges.

Curves inside another curve are holes of a domain; curves next to each other are separate shapes.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from meshonet.formats.mesh.loops import EdgeLoop, closed_loops
from meshonet.formats.mesh.unstructured import Indices
from meshonet.formats.source import LARGEST, printable
from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.domain.loop import turns_sharply
from meshonet.geometry.domain.nesting import nested
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.closed_curve import closed_curve
from meshonet.geometry.shapes.domain_shape import DomainShape, itself
from meshonet.geometry.shapes.named_edges import Labelled, runs
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.polygon_shape import PolygonRing, domain_or_body, polygon_shape
from meshonet.geometry.shapes.shape import Shape

MOST_EDGES = 400_000  # largest number of edges; more edges are taken for a mistake
NAMELESS = "boundary"  # name of edges without a name if other edges have names


@dataclass(frozen=True)
class MeshBoundary:
    """Boundary of a mesh of `points` (n, 2).

    Parameters
    ----------
    edges : point numbers (k, 2) of the edges of each name; if empty, edges that belong to only one cell.
    cells : point numbers (m, 3 or 4), an array for each kind of cell.
    """

    points: Floats
    edges: dict[str, Indices]
    cells: list[Indices] = field(default_factory=list)


def shapes_of(surface: MeshBoundary, name: str) -> Iterator[Shape]:
    """Yield the shapes that the closed curves of a mesh boundary form.

    A four-sided domain keeps its nodes if opposite sides have equal numbers of nodes. Its four corners are
    the nodes with one cell each, or the points where names of edges change. The south side contains the
    first edge of the file. A body and a far field keep their nodes if the cells between them are an O grid.
    Raises InputError if edges are too few, too many or not closed, or if a curve lies in a hole.
    """
    edges = surface.edges or {"": _free_edges(surface.cells)}
    count = sum(map(len, edges.values()))
    if not 1 <= count <= MOST_EDGES:
        raise InputError(f"has {count} boundary edges", f"give a mesh with 3 to {MOST_EDGES} of them")
    for rows in (*edges.values(), *surface.cells):
        if rows.size and not 0 <= rows.min() <= rows.max() < len(surface.points):
            raise InputError(f"names point {rows.max()} of {len(surface.points)}", "write the mesh again")
    used = np.unique(np.concatenate(list(edges.values())))
    if not (np.abs(surface.points[used]) < LARGEST).all():
        raise InputError("a coordinate is not finite or far too large", "check its numbers")
    loops = closed_loops(edges, surface.points)
    if count < 3:
        raise InputError(f"has {count} edges", "a closed curve needs at least 3")
    groups = nested([surface.points[loop.nodes] for loop in loops])
    for number, (outer, holes) in enumerate(groups, start=1):
        called = name if len(groups) == 1 else f"{name}-{number}"
        if holes:
            yield _with_holes(loops[outer], [loops[k] for k in holes], surface, called)
        else:
            yield _domain(loops[outer], surface, called)


def noted(shape: Shape, notes: tuple[str, ...]) -> Shape:
    """Return `shape` with additional `notes` about parts of its file that were left out."""
    if isinstance(shape, Labelled):
        noted(shape.shape, notes)
    elif isinstance(shape, Outline | Airfoil):
        shape.notes = (*notes, *shape.notes)
    elif isinstance(shape, DomainShape):
        return shape.noted(*notes)
    elif isinstance(shape, Boundary):
        return replace(shape, notes=(*notes, *shape.notes))
    return shape


def _free_edges(cells: list[Indices]) -> Indices:
    """Return the edges (k, 2) that belong to only one cell, with the cell on their left."""
    rings = [np.stack([rows, np.roll(rows, -1, axis=1)], axis=-1).reshape(-1, 2) for rows in cells]
    if not rings:
        return np.empty((0, 2), np.int64)
    edges = np.concatenate(rings)
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    return edges[np.sort(first[count == 1])]


def _with_holes(outer: EdgeLoop, holes: list[EdgeLoop], surface: MeshBoundary, name: str) -> Shape:
    """Return the domain of closed curves; the nodes of an O grid are kept."""
    points = surface.points
    if len(holes) == 1 and len(outer.nodes) == len(holes[0].nodes):
        inner, around = (
            loop.reversed() if polygon_area(points[loop.nodes]) > 0 else loop for loop in (holes[0], outer)
        )
        cut = _cut(inner, around, surface)
        if cut:
            around = around.begun_at(int(np.flatnonzero(around.nodes == cut[-1])[0]))
            south, north = (points[np.append(loop.nodes, loop.nodes[0])] for loop in (inner, around))
            parts = (*runs("south", inner.names), *runs("north", around.names))
            return Boundary(south, north, points[cut], points[cut], "o", parts, name)
    return polygon_shape([_ring(loop, points) for loop in (outer, *holes)], name)


def _ring(loop: EdgeLoop, points: Floats) -> PolygonRing:
    """Return a curve with corners where it turns, or names change."""
    ring, names = points[loop.nodes], [printable(name) for name in loop.names]
    if len(set(names)) == 1:
        return PolygonRing(ring, None, names[:1] if names[0] else ())
    turns = np.flatnonzero(turns_sharply(turning(ring, closed=True)))
    corners = sorted({*turns.tolist(), *loop.changes})
    return PolygonRing(ring, corners, [names[k] or NAMELESS for k in corners])


def _cut(inner: EdgeLoop, outer: EdgeLoop, surface: MeshBoundary) -> list[int]:
    """Return the nodes of a grid line from the first node of `inner` to the far field, if there is one."""
    if len(surface.cells) != 1 or surface.cells[0].shape[1] != 4:
        return []
    cut = _line_across(surface.cells[0], int(inner.nodes[0]), len(surface.points))
    return cut if cut and cut[-1] in outer.nodes else []


def _line_across(quads: Indices, start: int, count: int) -> list[int]:
    """Return the nodes of a grid line from boundary node `start` to the other boundary, or nothing.

    It goes straight on where four of the `quads` (m, 4) meet; `count` is the number of nodes.
    """
    order = np.argsort(quads.ravel(), kind="stable") // 4
    begin = np.concatenate([[0], np.cumsum(np.bincount(quads.ravel(), minlength=count))])

    def around(node: int) -> list[list[int]]:
        return quads[order[begin[node] : begin[node + 1]]].tolist()

    def beside(node: int, cell: list[int]) -> tuple[int, int]:
        at = cell.index(node)
        return cell[at - 1], cell[(at + 1) % 4]

    line, cells = [start], around(start)
    if len(cells) != 2:
        return []
    shared = set(beside(start, cells[0])) & set(beside(start, cells[1]))
    while len(shared) == 1 and len(line) <= count:
        line.append(shared.pop())
        cells = around(line[-1])
        if len(cells) == 2:
            return line
        ahead = [cell for cell in cells if line[-2] not in cell]
        if len(cells) != 4 or len(ahead) != 2:
            return []
        shared = set(beside(line[-1], ahead[0])) & set(beside(line[-1], ahead[1]))
    return []


def _domain(loop: EdgeLoop, surface: MeshBoundary, name: str) -> Shape:
    points = surface.points
    corners = _corners(loop, surface)
    if corners is None:
        curve = closed_curve(points[loop.nodes], name)
        interior = (bool(surface.cells) or len(set(loop.names)) > 1) and not isinstance(curve, Airfoil)
        if not interior and isinstance(domain_or_body(curve), Outline | Airfoil):
            return _labelled(curve, [loop], points)
        shape = polygon_shape([_ring(loop, points)], name)
        return replace(shape, one=partial(_labelled, curve, [loop], points))
    count, first = len(loop.nodes), 0
    if polygon_area(points[loop.nodes]) < 0:
        loop, first = loop.reversed(), count - 1
        corners = sorted((count - place) % count for place in corners)
    begin = max((place for place in corners if place <= first), default=corners[-1])
    loop, corners = loop.begun_at(begin), sorted((place - begin) % count for place in corners)
    counts = np.diff([*corners, len(loop.nodes)])
    ends_only = not surface.cells and counts.min() == 1
    if counts[0] != counts[2] or counts[1] != counts[3] or ends_only:
        a, b, c, d = corners
        outline = _labelled(Outline(points[loop.nodes], name, corners=(a, b, c, d)), [loop], points)
        inside = polygon_shape([_ring(loop, points)], name)
        if isinstance(inside, DomainShape):
            return replace(inside, many=False, one=partial(itself, outline))
        return outline
    ring, names = points[np.append(loop.nodes, loop.nodes[0])], loop.names
    stops = [*corners[1:], len(loop.nodes)]
    edges = {side: ring[start : stop + 1] for side, start, stop in zip(SIDES, corners, stops, strict=True)}
    named = {side: names[start:stop] for side, start, stop in zip(SIDES, corners, stops, strict=True)}
    for side in ("north", "west"):
        edges[side], named[side] = edges[side][::-1], named[side][::-1]
    parts = tuple(part for side in SIDES for part in runs(side, named[side]))
    return Boundary(edges["south"], edges["north"], edges["west"], edges["east"], "quad", parts, name)


def _corners(loop: EdgeLoop, surface: MeshBoundary) -> list[int] | None:
    """Return the indices of the four corners of a domain along `loop`, if there are four."""
    quads = [rows for rows in surface.cells if rows.shape[1] == 4]
    if len(quads) == 1 and len(surface.cells) == 1:
        met = np.bincount(quads[0].ravel(), minlength=len(surface.points))[loop.nodes]
        alone = np.flatnonzero(met == 1).tolist()
        if len(alone) == 4:
            return [int(place) for place in alone]
    return loop.changes if len(loop.changes) == 4 else None


def _labelled(shape: Shape, loops: list[EdgeLoop], points: Floats) -> Shape:
    """Return `shape` with the names of the edges from which it was made."""
    if not any(any(loop.names) for loop in loops):
        return shape
    ends = [np.stack([loop.nodes, np.roll(loop.nodes, -1)], axis=1) for loop in loops]
    names = [printable(name) for loop in loops for name in loop.names]
    return Labelled(shape, points[np.concatenate(ends)], tuple(names))


def flat(points: Floats) -> Floats:
    """Return x and y (n, 2) of points (n, 2 or 3). Raises InputError if z is not constant."""
    if points.shape[1] > 2 and len(points):
        z = points[:, 2]
        if not np.ptp(z) <= 1e-6 * max(float(np.ptp(points[:, :2])), 1e-300):
            raise InputError("its points do not lie in a plane z = constant", "give a mesh of two dimensions")
    return np.ascontiguousarray(points[:, :2])
