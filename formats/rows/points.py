"""Blocks of points in space as text: TurboGrid's ``.curve``, lists such as NASA's of Rotor 37, CSV.

Blank lines and text divide blocks. Marks of edges (``le1``, ``te2``) are ignored: edges are computed.
"""

import re
from collections.abc import Sequence

import numpy as np

from meshonet.formats.source import Source
from meshonet.formats.text.rows import Line, decode, read_lines, table
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError, in_source

MOST_POINTS = 200_000  # largest number of points; more points are taken for a mistake
_SPLITTER = re.compile(r"\bsplitter\b", re.IGNORECASE)  # word in the heading of a second blade (TurboGrid)
_BETWEEN = re.compile(r"[\s,;|]+")
_UNIT = re.compile(r"[\[(][^\])]*[\])]")
_MARK = re.compile(r"[\s,;]+(?:le|te)\d*[\s,;]*$", re.IGNORECASE | re.MULTILINE)
_ANGLES = ("theta", "t", "phi", "\u03b8", "\u03c6")
_NAMES = {"x", "y", "z", "r", *_ANGLES}


def point_blocks(source: Source, orders: Sequence[str]) -> list[Floats]:
    """Return the blocks (n, k) of points in a file; all have the same number k of columns.

    `orders` lists the permitted columns, such as ``x, y, z`` or ``x, r``; k tells which apply. Raises
    InputError if the columns are others, if there is no block, or if a heading names a splitter blade.
    """
    return [points for points, _ in placed_blocks(source, orders)]


def placed_blocks(source: Source, orders: Sequence[str]) -> list[tuple[Floats, str]]:
    """Return the blocks as `point_blocks` does, each with its place: ``lines 2 to 9 of a.curve``."""
    with in_source(source.name):
        text = decode(source.text_bytes())
        lines = read_lines(_MARK.sub("", text))
        for line in lines:
            if line.kind == "text" and _SPLITTER.search(line.text):
                problem = f"{line.text.strip()[:40]!r} is the heading of a splitter"
                remedy = "give one blade: splitters are not made"
                raise InputError(problem, remedy, place=f"line {line.number}")
        blocks = table(lines)
        counts = {order.count(",") + 1: order for order in orders}
        words = " or ".join(map(str, counts))
        if not blocks:
            raise InputError("holds no points", f"give {words} numbers a line")
        if sum(map(len, blocks)) > MOST_POINTS:
            raise InputError(f"{sum(map(len, blocks))} points", f"give at most {MOST_POINTS}")
        count = len(blocks[0][0].values)
        count = count if count in counts else next(iter(counts))
        made = [_points(block, count, words) for block in blocks]
        _check_names(lines, blocks, counts[count])
        name = source.path.name if source.path else source.name
        ends = [f"lines {block[0].number} to {block[-1].number} of {name}" for block in blocks]
        return list(zip(made, ends, strict=True))


def _points(block: Sequence[Line], count: int, words: str) -> Floats:
    for line in block:
        if len(line.values) != count:
            problem = f"{line.text.strip()[:40]!r} is not {count} numbers"
            raise InputError(problem, f"give {words} numbers a line", place=f"line {line.number}")
    return np.array([line.values for line in block])


def _check_names(lines: Sequence[Line], blocks: Sequence[Sequence[Line]], order: str) -> None:
    """Raise InputError if the line above a block names its columns in another order."""
    for block in blocks:
        above = lines[block[0].number - 2].text if block[0].number > 1 else ""
        names = _BETWEEN.split(_UNIT.sub("", above).lower().strip(" \t#!\"',;"))
        if len(names) != order.count(",") + 1 or not _NAMES.issuperset(names):
            continue
        if order == "x, y, z":
            fits = names == ["x", "y", "z"]
        else:
            fits = names[0] != "r" and (len(names) == 2 or (names[1] == "r" and names[2] in _ANGLES))
        problem, remedy = f"the columns are {', '.join(names)}", f"give {order} in this order"
        if {*names} & {*_ANGLES}:
            if order == "x, y, z":
                remedy = 'give x, r, theta, and write coordinates = "xrt"'
            elif fits and "deg" in above.lower():
                fits, problem, remedy = False, "theta is in degrees", "give it in radians"
        if not fits:
            raise InputError(problem, remedy, place=f"line {block[0].number - 1}")
