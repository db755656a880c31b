"""Airfoil coordinate files, in the many forms in which they are published.

Selig's order (trailing edge, upper side, leading edge, lower side, trailing edge), Lednicer's (a line with
two counts, then both surfaces from the leading edge), either of them backwards or without counts, from any
start; both surfaces from the trailing edge; a name line, an MSES line of four numbers, prose before and
behind the data or none of these; columns x y, n x y, x y z, x upper lower, or both surfaces side by side. The
unit and the position stay as they are.
https://m-selig.ae.illinois.edu/ads/coord_database.html
"""

import re
from collections.abc import Iterator

import numpy as np

from meshonet.formats.source import Source, printable
from meshonet.formats.text.rows import Line, decode, left_out, mostly_rows, read_lines, table
from meshonet.geometry.arrays import Floats, extent_of
from meshonet.geometry.errors import InputError, in_source
from meshonet.geometry.notes import Change
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

MOST_POINTS = 20_000
"""An airfoil of more points is a mistake."""
_ASK = "give an airfoil as lines of x y from the trailing edge round to it again, or in Lednicer's order"
"""Remedy for what is no airfoil."""


def read_shapes(source: Source) -> Iterator[Airfoil]:
    """Yield the airfoil of a file; InputError, with its line, where there is none."""
    yield parse(decode(source.read_bytes()), source.name, source.stem)


def parse(text: str, source: str, stem: str = "") -> Airfoil:
    r"""Return the airfoil that the text of the file `source` describes; `stem` is its name where it has none.

    >>> parse("Plate\n1 0\n.5 .05\n0 0\n.5 -.05\n1 0\n", "plate.dat").name
    'Plate'
    """
    with in_source(source):
        lines = read_lines(text)
        rows, blocks, counts = _data(lines)
        points, order, upper = _once_around(*_columns(rows), blocks)
        _check_run(points, [rows[k].number for k in order])
        places = [f"line {rows[k].number}" for k in order]
        notes = (*left_out(lines), *_wrong_counts(counts, len(rows), upper))
        return Airfoil(points, _name(lines, rows[0].number) or stem or source, places, notes)


def sniff(head: bytes) -> bool:
    """Say whether `head` is text most of whose lines are pairs of numbers."""
    return mostly_rows(head, (2,), least=4)


def _name(lines: list[Line], first: int) -> str:
    """Return the first text above line `first` of the data, or what stands there as a number."""
    for line in lines[: first - 1]:
        title = " ".join(line.text.strip("#!%*/ \t").split())
        if title:
            return printable(title[:80])
    return ""


def _data(lines: list[Line]) -> tuple[list[Line], list[int], Line | None]:
    """Return the rows that are coordinates, where among them a new block starts, and Lednicer's counts."""
    blocks = table(lines)
    count = sum(map(len, blocks))
    if count > MOST_POINTS:
        raise InputError(f"{count} points", f"an airfoil file has a few hundred; give at most {MOST_POINTS}")
    if count < 3:
        raise InputError(f"{count} lines of coordinates", _ASK)
    widths = [len(line.values) for block in blocks for line in block]
    usual = max(set(widths), key=lambda w: (widths.count(w), -w))
    # a longer row among the data has a remark behind it, above the data it is a heading of its own
    third = [line.number for block in blocks for line in block if len(line.values) == usual][:3][-1]
    fits = [
        [
            line
            for line in block
            if len(line.values) == usual or (len(line.values) > usual and line.number > third)
        ]
        for block in blocks
    ]
    blocks = [block for block in fits if block]
    while len(blocks) > 1 and len(blocks[-1]) < 3 and _is_apart(blocks, lines):
        blocks.pop()  # numbers in the prose behind the data
    rows = [line for block in blocks for line in block]
    starts = np.cumsum([0, *map(len, blocks[:-1])]).tolist()
    return _without_heading(_without_mark(rows), starts, usual)


def _is_apart(blocks: list[list[Line]], lines: list[Line]) -> bool:
    """Say whether the last block is apart from the data: by prose, or because it lies elsewhere."""
    before, last = blocks[-2][-1], blocks[-1][0]
    if any(line.kind not in ("blank", "gap") for line in lines[before.number : last.number - 1]):
        return sum(map(len, blocks[:-1])) >= 10
    points = np.array([line.values[:2] for block in blocks[:-1] for line in block])
    return _outside(np.array(last.values[:2]), points)


def _without_mark(rows: list[Line]) -> list[Line]:
    """Return rows without an end mark such as 999 999: the same number twice, far outside the data."""
    if len(rows) < 8:
        return rows
    points, last = (np.array([line.values[:2] for line in part]) for part in (rows[3:-1], rows[-1:]))
    marked = last[0, 0] == last[0, 1] and _outside(last[0], points, by=0.5)
    return rows[:-1] if marked else rows


def _outside(point: Floats, points: Floats, by: float = 1.0) -> bool:
    """Say whether a point (2,) lies more than the extent of the others, times `by`, outside their box."""
    low, high = points.min(axis=0), points.max(axis=0)
    reach = by * float((high - low).max())
    return bool((point < low - reach).any() or (point > high + reach).any())


def _without_heading(
    rows: list[Line], starts: list[int], width: int
) -> tuple[list[Line], list[int], Line | None]:
    """Return rows and starts of blocks without rows of numbers above the data that are no coordinates.

    Those are Lednicer's counts, which are returned too, and names or conditions that happen to be numbers:
    they lie far outside the rest, or are whole numbers, unlike the rest, and begin with 0 or stand far from
    the points next to them.
    """
    counts = None
    if width != 2:
        return rows, starts, counts
    for k in reversed(range(min(4, len(rows) - 4))):
        if _are_counts(rows[k], len(rows) - k - 1, len(rows) - k - 1):
            return rows[k + 1 :], [0, int(rows[k].values[0])], rows[k]
    while len(rows) > 4:
        rest = np.array([line.values[:2] for line in rows[1:]])
        point = np.array(rows[0].values[:2])
        extent = extent_of(rest)
        apart = float(np.hypot(*(rest[[0, -1]] - point).T).min())
        whole = "." not in rows[0].text and sum("." in line.text for line in rows[1:]) > 0.8 * len(rest)
        named = any(re.fullmatch(r"0\d+", word) for word in rows[0].text.split())
        if not (_outside(point, rest) or (whole and (named or apart > 0.2 * extent))):
            break
        if not named and _are_counts(rows[0], len(rest) // 2, 2 * len(rest)):
            counts = rows[0]
        rows, starts = rows[1:], sorted({max(start - 1, 0) for start in starts})
    return rows, starts, counts


def _are_counts(line: Line, least: int, most: int) -> bool:
    """Say whether `line` can be Lednicer's: two whole numbers from 2 on whose sum lies in the given range."""
    upper, lower = line.values[:2]
    whole = upper == int(upper) and lower == int(lower)
    return whole and min(upper, lower) >= 2 and least <= upper + lower <= most


def _wrong_counts(counts: Line | None, points: int, upper: int) -> tuple[str, ...]:
    """Return a note when a file announces other counts of points than its two surfaces have."""
    if counts is None:
        return ()
    first, both = counts.values[0], sum(counts.values[:2])
    if (upper or first) == first and points == both:
        return ()
    surfaces = f"{upper} and {points - upper} follow" if upper else f"{points} follow"
    text = f"line {counts.number} announces {counts.text.strip()} points and {surfaces}, which are read"
    return (Change(text),)


def _columns(rows: list[Line]) -> tuple[Floats, list[int]]:
    """Return points (n, 2) and the row each stands in, from tables of two or more columns."""
    width = min(len(line.values) for line in rows)
    values = np.array([line.values[:width] for line in rows])
    index = list(range(len(rows)))
    numbered = values[0, 0] in (0, 1) and np.array_equal(values[:, 0], values[0, 0] + np.arange(len(rows)))
    if width > 2 and numbered:
        values, width = values[:, 1:], width - 1
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
    """Return the points in one run around the section, the row of each, and how many the first surface has.

    Either they run so already, and 0 stands for the first surface, or they are two surfaces that both start
    at the same edge, the first of which is then to be reversed. The division is where a block starts or at
    the widest step; what gives the shortest way round is right. It starts at the edge where both end, the
    trailing one in Lednicer's order; where that lies ahead, at smaller x, at the other: only a sharp edge
    would tell it without.
    """
    n = len(points)
    steps = np.hypot(*np.diff(points, axis=0).T)
    half = [n // 2] if n == 2 * len(set(index)) else []  # two surfaces side by side
    breaks = {k for k in (*starts, *half, int(np.argmax(steps)) + 1) if 2 <= k <= n - 2}
    best, order, first = 0.98 * _way_round(points), np.arange(n), 0
    for k in sorted(breaks):
        turned = np.concatenate([np.arange(k)[::-1], np.arange(k, n)])
        length = _way_round(points[turned])
        if length < best:
            ahead = points[turned[[0, -1]], 0].max() < points[[0, k], 0].min()
            best, order, first = length, np.roll(turned, -k) if ahead else turned, k
    return points[order], [index[k] for k in order], first


def _way_round(points: Floats) -> float:
    return float(np.hypot(*np.diff(points, axis=0, append=points[:1]).T).sum())


def _check_run(points: Floats, numbers: list[int]) -> None:
    """Raise when the points go more than once around, or one lies far from both its neighbours."""
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
    closed = [k for k in back.tolist() if 8 <= k < n - 7 and length[k] > 0.02 * extent]
    if closed or length.sum() > 3.5 * extent:
        k = closed[0] if closed else int(np.argmax(length))
        raise InputError(
            f"the points go more than once around: widest step, line {numbers[k]} to {numbers[(k + 1) % n]}",
            "give one element alone, " + _ASK.removeprefix("give an airfoil "),
        )
