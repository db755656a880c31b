"""Lists of points: closed curves, or sides of a domain in blocks (docs/reference/shapes.md)."""

from collections.abc import Iterator
from pathlib import Path
from typing import TypeVar

import numpy as np

from meshonet.formats.mesh.surface import noted, shapes_of
from meshonet.formats.outlines.joined import MEET, joined
from meshonet.formats.source import Source, printable
from meshonet.formats.text.rows import Line, decode, left_out, mostly_rows, read_lines, table
from meshonet.geometry.arrays import ends_meet, extent_of
from meshonet.geometry.domain.nesting import nested
from meshonet.geometry.errors import InputError, in_source
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.closed_curve import closed_curve
from meshonet.geometry.shapes.edges import DrawnEdge, channel, four_edges
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.polygon_shape import PolygonRing, domain_or_body, polygon_shape
from meshonet.geometry.shapes.shape import Shape

AnyOutline = TypeVar("AnyOutline", bound=Outline | Airfoil)
MOST_POINTS = 100_000  # largest number of points of a curve; more are taken for a mistake


def read_shapes(source: Source) -> Iterator[Shape]:
    """Yield the shapes in a file of points. Raises InputError if there is none."""
    yield from parse(decode(source.text_bytes()), source.name, source.stem)


def parse(text: str, source: str, stem: str = "") -> list[Shape]:
    r"""Return the shapes in a list of points; they are named `stem`, or `source` if it is empty.

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
        if (
            len(blocks) == len(rings) in (2, 4)
            and min(map(len, blocks)) >= 2
            and not all(map(_closed, rings))
        ):
            edges = _edges(blocks, lines)
            if len(edges) == 4:
                return [four_edges(edges, name, notes)]
            if all(edge.is_wall for edge in edges):
                return [channel(edges, name, notes)]
        drawn = [(edge.name, edge.points) for edge in _edges(blocks, lines)] if len(blocks) > 1 else []
        if drawn and _are_sides(blocks, named=bool(drawn[0][0])):
            return [noted(shape, notes) for shape in shapes_of(joined(drawn), name)]
        if not rings:
            raise InputError("0 blocks of points", "give closed curves, or four edges divided by blank lines")
        few = next((ring for ring in rings if len(ring) < 3), None)
        if few is not None:
            _check_words(few, lines)
        if len(rings) == 1:
            return [domain_or_body(_with_notes(_closed_curve(rings[0], name), notes))]
        names = [""] * len(rings)
        if len(rings) == len(blocks):
            names = [called for called, _ in drawn]
        return _domains(rings, names, name, notes)


def sniff(head: bytes) -> bool:
    """Return whether the first bytes of a file are text with two or three numbers in most lines."""
    return mostly_rows(head, (1, 2, 3), least=3)


def _with_notes(shape: AnyOutline, notes: tuple[str, ...]) -> AnyOutline:
    shape.notes = (*notes, *shape.notes)
    return shape


def _edges(blocks: list[list[Line]], lines: list[Line]) -> list[DrawnEdge]:
    """Return blocks as edges, named by lines ``# name`` above if all have one."""
    above = [lines[block[0].number - 2].text.strip() if block[0].number > 1 else "" for block in blocks]
    names = [printable(text.strip("#").strip()) if text.startswith("#") else "" for text in above]
    return [
        DrawnEdge(
            np.array([line.values[:2] for line in block]), [f"line {line.number}" for line in block], called
        )
        for block, called in zip(blocks, names if all(names) else [""] * len(names), strict=True)
    ]


def _are_sides(blocks: list[list[Line]], named: bool) -> bool:
    """Return whether some blocks are open curves, and each of their ends meets that of another."""
    ends = [block[k].values[:2] for block in blocks if len(block) > 1 and not _closed(block) for k in (0, -1)]
    if not ends or min(map(len, blocks)) < 2:
        return False
    if named and min(map(len, blocks)) == 2:
        return True
    points = np.array([line.values[:2] for block in blocks for line in block])
    apart = np.hypot(*(np.array(ends)[:, None] - np.array(ends)).transpose(2, 0, 1))
    return bool(((apart <= MEET * extent_of(points)).sum(axis=1) > 1).all())


def _closed(rows: list[Line]) -> bool:
    return len(rows) > 3 and ends_meet(np.array([line.values[:2] for line in rows]))


def _rings(rows: list[Line]) -> list[list[Line]]:
    """Return the closed curves in a block, each ending with its first point or at the end of the block."""
    rings, start = [], 0
    while start < len(rows):
        first = rows[start].values[:2]
        end = next((k for k in range(start + 3, len(rows)) if rows[k].values[:2] == first), None)
        if end is None:
            return [rows]
        rings.append(rows[start : end + 1])
        start = end + 1
    return rings


def _check_words(rows: list[Line], lines: list[Line]) -> None:
    """Raise InputError if words that are no heading stand before or after a curve of too few points."""
    words = [each for each in lines[1:] if each.kind not in ("blank", "row", "noted")]
    words = [each for each in words if not each.text.lstrip().startswith("#")]
    if words:
        near = min(words, key=lambda each: min(abs(each.number - row.number) for row in rows))
        problem = f"{near.text.strip()[:40]!r} is no pair of numbers, and too few points are beside it"
        remedy = "correct the line, or give at least 3 points of a closed curve"
        raise InputError(problem, remedy, place=f"line {near.number}")


def _domains(rings: list[list[Line]], names: list[str], name: str, notes: tuple[str, ...]) -> list[Shape]:
    """Return the domain of each ring that is not inside another one; rings inside it are its holes."""
    few = next((ring for ring in rings if len(ring) < 3), None)
    if few is not None:
        problem, place = f"{len(rings)} blocks of points, one of {len(few)}", f"line {few[0].number}"
        raise InputError(problem, "give closed curves, or four edges divided by blank lines", place=place)
    drawn = [
        PolygonRing(
            np.array([line.values[:2] for line in ring]),
            names=[own] * bool(own),
            places=[f"line {line.number}" for line in ring],
        )
        for ring, own in zip(rings, names, strict=True)
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
