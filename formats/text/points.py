"""Lists of points: closed curves, or the four edges of a domain in four blocks divided by blank lines.

Columns are divided by commas, semicolons, blanks or tabs; a header line and lines that start with ``#`` are
allowed; a third column is z and is left out. An open curve is closed by a straight line.

Four blocks are edges in any order and direction as long as they meet; the first is south. Where opposite
edges have equal counts, the points are the nodes of the boundary as they stand; otherwise curves to sample.
A single curve that ends in one trailing edge is taken for an airfoil. Several closed curves are divided by
blank lines, or each repeats its first point; those in another one are holes in the domain that it bounds.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from meshonet.formats.source import Source
from meshonet.formats.text.rows import Line, decode, left_out, mostly_rows, read_lines, table
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.domain.nesting import nested
from meshonet.geometry.errors import InputError, in_source
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.self_intersection import check_outline
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.closed_curve import closed_curve
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.polygon_shape import PolygonRing, domain_or_body, polygon_shape
from meshonet.geometry.shapes.shape import Shape

AnyOutline = TypeVar("AnyOutline", bound=Boundary | Outline | Airfoil)
MOST_POINTS = 100_000
"""A curve of more points is a mistake."""
_JOIN = 1e-6
"""How far apart, in extents, the ends of two edges may lie and still meet."""


def read_shapes(source: Source) -> Iterator[Shape]:
    """Yield the shapes of a file; InputError, with its line, where there is none."""
    yield from parse(decode(source.text_bytes()), source.name, source.stem)


def parse(text: str, source: str, stem: str = "") -> list[Shape]:
    r"""Return the shapes that the text of a list of points describes, called `stem` or else as `source`.

    >>> (square,) = parse("x,y\n0,0\n1,0\n1,1\n0,1\n", "square.csv")
    >>> square.name, square.topology
    ('square', 'quad')
    """
    name = stem or Path(source).stem
    with in_source(source):
        lines = read_lines(text)
        blocks = table(lines)
        count = sum(map(len, blocks))
        if count > MOST_POINTS:
            raise InputError(f"{count} points", f"give at most {MOST_POINTS}")
        if len(blocks) > 4 and max(map(len, blocks)) == 1:
            blocks = [[line for block in blocks for line in block]]  # a blank line behind each
        notes = left_out(lines)
        rings = [ring for block in blocks for ring in _rings(block)]
        if len(blocks) == 4 == len(rings) and min(map(len, blocks)) >= 2 and not all(map(_closed, rings)):
            return [_with_notes(_four_edges(blocks, name), notes)]
        if not rings:
            raise InputError("0 blocks of points", "give closed curves, or four edges divided by blank lines")
        if len(rings) == 1:
            return [domain_or_body(_with_notes(_closed_curve(rings[0], name), notes))]
        return _domains(rings, name, notes)


def sniff(head: bytes) -> bool:
    """Say whether `head` is text of which most lines are two or three numbers."""
    return mostly_rows(head, (1, 2, 3), least=3)


def _with_notes(shape: AnyOutline, notes: tuple[str, ...]) -> AnyOutline:
    if isinstance(shape, Boundary):
        return replace(shape, notes=(*notes, *shape.notes))
    shape.notes = (*notes, *shape.notes)
    return shape


def _closed(rows: list[Line]) -> bool:
    return len(rows) > 3 and rows[0].values[:2] == rows[-1].values[:2]


def _rings(rows: list[Line]) -> list[list[Line]]:
    """Return the closed curves that follow each other in a block, each ending with its first point, or it."""
    rings, start = [], 0
    while start < len(rows):
        first = rows[start].values[:2]
        end = next((k for k in range(start + 3, len(rows)) if rows[k].values[:2] == first), None)
        if end is None:
            return [rows]
        rings.append(rows[start : end + 1])
        start = end + 1
    return rings


def _domains(rings: list[list[Line]], name: str, notes: tuple[str, ...]) -> list[Shape]:
    """Return the domain of each ring that lies in no other; the rings in it are its holes."""
    few = next((ring for ring in rings if len(ring) < 3), None)
    if few is not None:
        problem, place = f"{len(rings)} blocks of points, one of {len(few)}", f"line {few[0].number}"
        raise InputError(problem, "give closed curves, or four edges divided by blank lines", place=place)
    drawn = [
        PolygonRing(
            np.array([line.values[:2] for line in ring]), places=[f"line {line.number}" for line in ring]
        )
        for ring in rings
    ]
    groups = nested([ring.points for ring in drawn])
    shapes: list[Shape] = []
    for number, (outer, holes) in enumerate(groups, start=1):
        called = name if len(groups) == 1 else f"{name}-{number}"
        if holes:
            shapes.append(polygon_shape([drawn[outer], *(drawn[k] for k in holes)], called, notes))
        else:
            shapes.append(domain_or_body(_with_notes(_closed_curve(rings[outer], called), notes)))
    return shapes


def _closed_curve(rows: list[Line], name: str) -> Outline | Airfoil:
    points = np.array([line.values[:2] for line in rows])
    return closed_curve(points, name, [f"line {line.number}" for line in rows])


def _four_edges(blocks: list[list[Line]], name: str) -> Boundary | Outline:
    """Return the domain of four edges, chained end to end from the first."""
    chain = _chained([_edge(block) for block in blocks])
    ring = np.concatenate([edge[:-1] for edge in chain])
    check_outline(ring[:, :2], [f"line {number:.0f}" for number in ring[:, 2]])
    if polygon_area(ring[:, :2]) < 0:  # the first edge stays south, so it is walked the other way
        chain = [chain[0][::-1], *(edge[::-1] for edge in chain[:0:-1])]
        ring = np.concatenate([edge[:-1] for edge in chain])
    counts = [len(edge) for edge in chain]
    if counts[0] == counts[2] and counts[1] == counts[3]:
        south, east, north, west = (edge[:, :2] for edge in chain)
        return Boundary(south, north[::-1], west[::-1], east, name=name)
    a, b, c = np.cumsum(np.array(counts[:3]) - 1).tolist()
    return Outline(ring[:, :2], name, corners=(0, a, b, c))


def _edge(block: list[Line]) -> Floats:
    """Return the points of a block and the number of each one's line (n, 3)."""
    edge = np.array([[*line.values[:2], line.number] for line in block])
    same = np.flatnonzero((np.diff(edge[:, :2], axis=0) == 0).all(axis=1))
    if len(same) == len(edge) - 1:
        place = f"line {block[0].number}"
        raise InputError("an edge is one point", "give two or more points of every edge", place=place)
    if same.size:
        x, y, _ = edge[same[0]]
        place = f"line {block[same[0] + 1].number}"
        raise InputError(f"repeats the point ({x:.6g}, {y:.6g}) of the line before", "remove it", place=place)
    return edge


def _chained(edges: list[Floats]) -> list[Floats]:
    """Return four edges (n, 3) in an order and directions in which each begins where the last one ends."""
    reach = _JOIN * float(np.hypot(*np.ptp(np.concatenate(edges)[:, :2], axis=0)))
    chain, left = [edges[0]], {1, 2, 3}
    while left:
        end = chain[-1][-1, :2]
        gaps = {(k, way): float(np.hypot(*(edges[k][::way][0, :2] - end))) for k in left for way in (1, -1)}
        (k, way), gap = min(gaps.items(), key=lambda item: item[1])
        if gap > reach:
            x, y = end
            problem = f"no other edge starts or ends at ({x:g}, {y:g}); the nearest is {gap:.3g} away"
            place = f"line {edges[k][::way][0, 2]:.0f}"
            raise InputError(problem, "make the four edges meet", place=place)
        chain.append(edges[k][::way].copy())
        chain[-1][0, :2] = end
        left.remove(k)
    gap = float(np.hypot(*(chain[3][-1, :2] - chain[0][0, :2])))
    if gap > reach:
        raise InputError(f"the four edges do not close: {gap:.3g} are left open", "make the four edges meet")
    chain[3][-1, :2] = chain[0][0, :2]
    return chain
