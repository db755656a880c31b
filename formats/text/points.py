"""Lists of points: one closed curve, or the four edges of a domain in four blocks divided by blank lines.

Columns are divided by commas, semicolons, blanks or tabs; a header line and lines that start with ``#`` are
allowed; a third column is z and is left out. An open curve is closed by a straight line.

Four blocks are edges in any order and direction as long as they meet; the first is south. Where opposite
edges have equal counts, the points are the nodes of the boundary as they stand; otherwise curves to sample.
A single curve that ends in one trailing edge is taken for an airfoil.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from meshonet.formats.mesh.closed_curve import closed_curve
from meshonet.formats.source import Source
from meshonet.formats.text.rows import Line, decode, left_out, read_lines, table
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, in_source
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.self_intersection import check_outline
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.shape import Shape

MOST_POINTS = 100_000
_JOIN = 1e-6
"""How far apart, in extents, the ends of two edges may lie and still meet."""


def read_shapes(source: Source) -> Iterator[Shape]:
    """Yield the shape of a file; InputError, with its line, where there is none."""
    yield parse(decode(source.read_bytes()), source.name, source.stem)


def parse(text: str, source: str, stem: str = "") -> Shape:
    r"""Return the shape that the text of a list of points describes, called `stem` or else as `source`.

    >>> square = parse("x,y\n0,0\n1,0\n1,1\n0,1\n", "square.csv")
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
        if len(blocks) == 4 and min(map(len, blocks)) >= 2:
            return _with_notes(_four_edges(blocks, name), left_out(lines))
        if len(blocks) != 1:
            remedy = "give one closed curve, or four edges divided by blank lines"
            place = f"line {blocks[1][0].number}" if len(blocks) > 1 else ""
            raise InputError(f"{len(blocks)} blocks of points", remedy, place=place)
        return _with_notes(_closed_curve(blocks[0], name), left_out(lines))


def sniff(head: bytes) -> bool:
    """Say whether `head` is text of which most lines are two or three numbers."""
    try:
        lines = read_lines(decode(head))
    except InputError:
        return False
    rows = [line for line in lines if line.kind == "row"]
    few = sum(len(line.values) <= 3 for line in rows)
    return few >= 3 and few >= 0.8 * len(rows)


def _with_notes(shape: Boundary | Outline | Airfoil, notes: tuple[str, ...]) -> Shape:
    if isinstance(shape, Boundary):
        return replace(shape, notes=(*notes, *shape.notes))
    shape.notes = (*notes, *shape.notes)
    return shape


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
