"""Points in space, in blocks: profiles of blades, hub and shroud.

TurboGrid's ``.curve`` files, lists as NASA's of Rotor 37, and CSV: three numbers a line, blocks divided by
blank lines or lines of text such as ``# Profile 1 at 0.00%``. Marks of edges (``le1``, ``te2``) are left out,
since edges are looked for.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from meshonet.formats.source import Source
from meshonet.formats.text.rows import Line, decode, read_lines, table
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError, in_source

MOST_POINTS = 200_000
"""More are a mistake."""
_MARK = re.compile(r"[\s,;]+(?:le|te)\d*[\s,;]*$", re.IGNORECASE | re.MULTILINE)


def point_blocks(source: Source, columns: tuple[int, ...]) -> list[Floats]:
    """Return the blocks (n, k) of a file; k is the same in all, and one of `columns`.

    Raises InputError: a line of another count of numbers, with its place; no block.
    """
    return [points for points, _ in placed_blocks(source, columns)]


def placed_blocks(source: Source, columns: tuple[int, ...]) -> list[tuple[Floats, str]]:
    """Return the blocks of a file as `point_blocks`, and where each is: ``lines 2 to 161 of a.curve``."""
    with in_source(source.name):
        blocks = table(read_lines(_MARK.sub("", decode(source.text_bytes()))))
        if not blocks:
            raise InputError("holds no points", f"give {_words(columns)} numbers a line")
        if sum(map(len, blocks)) > MOST_POINTS:
            raise InputError(f"{sum(map(len, blocks))} points", f"give at most {MOST_POINTS}")
        count = len(blocks[0][0].values)
        count = count if count in columns else columns[0]
        name = source.path.name if source.path else source.name
        ends = [f"lines {block[0].number} to {block[-1].number} of {name}" for block in blocks]
        return list(zip([_points(block, count, columns) for block in blocks], ends, strict=True))


def _points(block: Sequence[Line], count: int, columns: tuple[int, ...]) -> Floats:
    for line in block:
        if len(line.values) != count:
            problem = f"{line.text.strip()[:40]!r} is not {count} numbers"
            remedy = f"give {_words(columns)} numbers a line"
            raise InputError(problem, remedy, place=f"line {line.number}")
    return np.array([line.values for line in block])


def _words(columns: tuple[int, ...]) -> str:
    return " or ".join(map(str, columns))
