"""Airfoil coordinate files in the various published forms (docs/reference/shapes.md).

Selig's order, Lednicer's, or both surfaces from one edge; x y, n x y, x y z, or surfaces side by side.
https://m-selig.ae.illinois.edu/ads/coord_database.html
"""

import re
from collections.abc import Iterator
from functools import partial
from itertools import chain
from operator import attrgetter

import numpy as np

from meshonet.formats.source import Source, printable
from meshonet.formats.text.rows import Line, decode, left_out, mostly_rows, read_lines, table
from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.errors import InputError, in_source
from meshonet.geometry.notes import Change
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

MOST_POINTS = 20_000  # largest number of points; more are taken for a mistake
_ASK = "give an airfoil as lines of x y from the trailing edge round to it again, or in Lednicer's order"
"""Remedy for a file that is not an airfoil."""

sniff = partial(mostly_rows, counts=(2,), least=4)  # whether most lines of bytes are pairs of numbers


def read_shapes(source: Source) -> Iterator[Airfoil]:
    """Yield the airfoil in a file. Raises InputError, with the line, if the file contains no airfoil."""
    yield parse(decode(source.text_bytes()), source.name)


def parse(text: str, source: str) -> Airfoil:
    r"""Return the airfoil in a text; without a name in the text, it is named after the file `source`.

    >>> parse("Plate\n1 0\n.5 .05\n0 0\n.5 -.05\n1 0\n", "plate.dat").name
    'Plate'
    """
    with in_source(source):
        lines = read_lines(text)
        rows, blocks, counts = _data(lines)
        points, order, upper = _once_around(*_columns(rows), blocks)
        numbers = list(map(attrgetter("number"), map(rows.__getitem__, order)))
        _check_run(points, numbers)
        notes = left_out(lines)
        if counts is not None:
            notes += _wrong_counts(counts, len(rows), upper)
        name = _name(lines, rows[0].number) or Source(source).stem
        return Airfoil(points, name, list(map("line {}".format, numbers)), notes)


def _name(lines: list[Line], first: int) -> str:
    """Return the first text above line `first` of the data, or a number in its place."""
    for line in lines[: first - 1]:
        percent = "%" if line.text.lstrip().startswith("%") else ""  # at the end alone it is part of the name
        title = " ".join(line.text.lstrip("#!%*/ \t").rstrip(f"#!*/ \t{percent}").split())
        if title:
            return printable(title[:80])
    return ""


def _data(lines: list[Line]) -> tuple[list[Line], list[int], Line | None]:
    """Return the rows of coordinates, where blocks start, and Lednicer's counts."""
    blocks = table(lines)
    rows = list(chain.from_iterable(blocks))
    if len(rows) > MOST_POINTS:
        problem = f"{len(rows)} points"
        raise InputError(problem, f"an airfoil file has a few hundred; give at most {MOST_POINTS}")
    if len(rows) < 3:
        raise InputError(f"{len(rows)} lines of coordinates", _ASK)
    widths = list(map(len, map(attrgetter("values"), rows)))
    usual = widths[0]
    if len(set(widths)) > 1:
        usual = max(sorted(set(widths)), key=widths.count)
        blocks = _of_width(blocks, usual)
    while len(blocks) > 1 and len(blocks[-1]) < 3 and _is_apart(blocks, lines):
        blocks.pop()  # numbers in the prose behind the data
    rows = list(chain.from_iterable(blocks))
    starts = np.cumsum([0, *map(len, blocks[:-1])]).tolist()
    points = _points(rows)
    if len(rows) >= 8 and points[-1, 0] == points[-1, 1] and _outside(points[-1], points[3:-1], by=0.5):
        rows.pop()  # an end mark such as 999 999: the same number twice, far outside the data
    return _without_heading(rows, starts) if usual == 2 else (rows, starts, None)


def _of_width(blocks: list[list[Line]], usual: int) -> list[list[Line]]:
    """Return blocks of rows of this width; a longer row within the data ends in a remark."""
    third = [line.number for block in blocks for line in block if len(line.values) == usual][:3][-1]
    fits = [
        [n for n in block if len(n.values) == usual or (len(n.values) > usual and n.number > third)]
        for block in blocks
    ]
    return [block for block in fits if block]


def _points(rows: list[Line]) -> Floats:
    """Return the first two numbers of rows as points (n, 2)."""
    return np.array([line.values[:2] for line in rows])


def _is_apart(blocks: list[list[Line]], lines: list[Line]) -> bool:
    """Return whether the last block follows prose, or lies elsewhere."""
    before, last = blocks[-2][-1], blocks[-1][0]
    if any(line.kind not in ("blank", "gap") for line in lines[before.number : last.number - 1]):
        return sum(map(len, blocks[:-1])) >= 10
    points = np.array([line.values[:2] for block in blocks[:-1] for line in block])
    return _outside(np.array(last.values[:2]), points)


def _outside(point: Floats, points: Floats, by: float = 1.0) -> bool:
    """Return whether a point (2,) is outside the box of `points` by more than `by` times its extent."""
    low, high = points.min(axis=0), points.max(axis=0)
    reach = by * float((high - low).max())
    return bool((point < low - reach).any() or (point > high + reach).any())


def _without_heading(rows: list[Line], starts: list[int]) -> tuple[list[Line], list[int], Line | None]:
    """Return rows and starts of blocks without leading numbers, and Lednicer's counts among these.

    Names, conditions and counts lie far outside the other points, or are integers unlike the other rows.
    """
    counts = None
    for k in reversed(range(min(4, len(rows) - 4))):
        if _are_counts(rows[k], len(rows) - k - 1, len(rows) - k - 1):
            return rows[k + 1 :], [0, int(rows[k].values[0])], rows[k]
    points = _points(rows)
    while len(rows) > 4:
        point, rest = points[0], points[1:]
        named = re.search(r"(?<!\S)0\d+(?!\S)", rows[0].text) is not None
        if not _outside(point, rest) and ("." in rows[0].text or not _unlike(rows, rest, point, named)):
            break
        if not named and _are_counts(rows[0], len(rest) // 2, 2 * len(rest)):
            counts = rows[0]
        rows, points, starts = rows[1:], rest, sorted({max(start - 1, 0) for start in starts})
    return rows, starts, counts


def _unlike(rows: list[Line], rest: Floats, point: Floats, named: bool) -> bool:
    """Return whether a first row of integers starts with 0, or is far away."""
    apart = float(np.hypot(*(rest[[0, -1]] - point).T).min())
    fractions = sum("." in line.text for line in rows[1:])
    return fractions > 0.8 * len(rest) and (named or apart > 0.2 * extent_of(rest))


def _are_counts(line: Line, least: int, most: int) -> bool:
    """Return whether `line` has two integers above 1 with a sum in the given range."""
    upper, lower = line.values[:2]
    whole = upper == int(upper) and lower == int(lower)
    return whole and min(upper, lower) >= 2 and least <= upper + lower <= most


def _wrong_counts(counts: Line, points: int, upper: int) -> tuple[str, ...]:
    """Return a note if the counts in the file differ from those of its two surfaces."""
    first, both = counts.values[0], sum(counts.values[:2])
    if (upper or first) == first and points == both:
        return ()
    surfaces = f"{upper} and {points - upper} follow" if upper else f"{points} follow"
    text = f"line {counts.number} announces {counts.text.strip()} points and {surfaces}, which are read"
    return (Change(text),)


def _columns(rows: list[Line]) -> tuple[Floats, list[int]]:
    """Return points (n, 2) from tables with two or more columns, and the row of each point."""
    width, index = min(map(len, map(attrgetter("values"), rows))), list(range(len(rows)))
    if width == 2:
        return _points(rows), index
    values = np.array([line.values[:width] for line in rows])
    if values[0, 0] in (0, 1) and np.array_equal(values[:, 0], values[0, 0] + np.arange(len(rows))):
        values, width = values[:, 1:], width - 1  # numbered
    if width == 3 and np.ptp(values[:, 2]) > 0 and np.ptp(values[:, 1]) == 0:
        return values[:, [0, 2]], index  # x and z, in a plane of constant y
    runs = [_monotone(values[:, k]) for k in range(width)]
    if width == 3 and np.ptp(values[:, 2]) > 0 and runs[0]:
        upper, lower = values[:, [0, 1]], values[:, [0, 2]]
        return np.concatenate([upper, lower]), index + index
    if width == 4 and runs[0] and runs[2]:
        return np.concatenate([values[:, :2], values[:, 2:]]), index + index
    if width > 3 and runs[0]:
        problem = f"{width} columns, the first of them rising or falling"
        raise InputError(problem, _ASK, place=f"line {rows[0].number}")
    return values[:, :2], index


def _monotone(x: Floats) -> bool:
    step = np.diff(x)
    return bool((step >= 0).mean() > 0.95 or (step <= 0).mean() > 0.95)


def _once_around(points: Floats, index: list[int], starts: list[int]) -> tuple[Floats, list[int], int]:
    """Return the points in one run around the section, the row of each, and the count on the first surface.

    The count is 0 for a single run. Two surfaces from one edge are divided where a block starts or at the
    longest step, whichever gives the shorter outline, and the first is reversed. The run starts where both
    end; if that edge has the smaller x, at the other edge, since otherwise only sharp edges could be
    recognised.
    """
    n = len(points)
    steps = np.hypot(*np.diff(points, axis=0).T)
    half = [n // 2] if n == 2 * len(set(index)) else []  # two surfaces side by side
    best, order, first = 0.98 * _way_round(points), np.arange(n), 0
    for k in sorted({*starts, *half, int(np.argmax(steps)) + 1}):
        if not 2 <= k <= n - 2:
            continue
        turned = np.concatenate([np.arange(k)[::-1], np.arange(k, n)])
        length = _way_round(points[turned])
        if length < best:
            ahead = points[turned[[0, -1]], 0].max() < points[[0, k], 0].min()
            best, order, first = length, np.roll(turned, -k) if ahead else turned, k
    return points[order], np.array(index)[order].tolist(), first


def _way_round(points: Floats) -> float:
    return float(np.hypot(*np.diff(points, axis=0, append=points[:1]).T).sum())


def _check_run(points: Floats, numbers: list[int]) -> None:
    """Raise InputError if points go around twice, or one is far from both neighbours."""
    steps = np.diff(points, axis=0, append=points[:1])
    length = np.hypot(steps[:, 0], steps[:, 1])
    extent = float(np.hypot(*np.ptp(points, axis=0)))
    n = len(points)
    if n >= 12:
        direct = np.hypot(*(np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)).T)
        detour = np.roll(length, 1) + length - 5 * direct
        k = int(np.argmax(detour))
        others = np.delete(points, k, axis=0)
        most = 0.6 if k in (0, n - 1) else 0.3  # an edge may lie apart from the last points of both surfaces
        if detour[k] > most * float(np.hypot(*np.ptp(others, axis=0))):
            x, y = points[k]
            problem = f"({x:g}, {y:g}) lies far from the points before and after it"
            raise InputError(problem, "correct or remove it", place=f"line {numbers[k]}")
    back = np.flatnonzero(np.hypot(*(points - points[0]).T) < 0.02 * extent)
    closed = back[(back >= 8) & (back < n - 7) & (length[back] > 0.02 * extent)]
    if len(closed) or length.sum() > 3.5 * extent:
        k = int(closed[0]) if len(closed) else int(np.argmax(length))
        raise InputError(
            f"the points go more than once around: widest step, line {numbers[k]} to {numbers[(k + 1) % n]}",
            "give one element alone, " + _ASK.removeprefix("give an airfoil "),
        )
