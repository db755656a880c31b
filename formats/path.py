"""Paths in space for sweeping: points x, y, z, one per line, or pieces in TOML (docs/guide/pipes.md)."""

import math

import numpy as np

from meshonet.formats.source import Source, open_source
from meshonet.formats.text.rows import decode, read_lines, table
from meshonet.formats.toml_table import Table, toml_table
from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.path import Bend, Path, PiecedPath, SplinePath
from meshonet.geometry.errors import InputError, in_source

MOST_POINTS = 100_000  # largest number of points; a longer path is taken for a mistake


def path_of(text: str) -> Path:
    """Return the curve in the file `text`, which is a list of points or TOML; ``-`` is standard input.

    Points give a smooth curve, closed if the last is the first. Raises InputError, with the place, if the
    file is unreadable, a line does not have three numbers, a key is unknown, or a value is invalid.
    """
    source = open_source(text)
    with in_source(source.name):
        if source.suffix != ".toml":
            return SplinePath(_points(source))
        data = toml_table(source)
        data.only("start", "direction", "pieces")
        pieces = tuple(map(_piece, data.rows("pieces")))
        start, direction = data.vector("start", (0.0, 0.0, 0.0)), data.vector("direction", (1.0, 0.0, 0.0))
        return PiecedPath(pieces, np.array(start), np.array(direction))


def _points(source: Source) -> Floats:
    """Return the points (n, 3) of a text."""
    rows = [line for block in table(read_lines(decode(source.text_bytes()))) for line in block]
    if len(rows) > MOST_POINTS:
        raise InputError(f"{len(rows)} points", f"give at most {MOST_POINTS}")
    for line in rows:
        if len(line.values) < 3:
            problem = f"{line.text.strip()[:40]!r} is not x, y and z"
            raise InputError(problem, "give three numbers a line", place=f"line {line.number}")
    if len(rows) < 2:
        raise InputError(f"holds {len(rows)} points", "give x, y and z of two or more, one a line")
    return np.array([line.values[:3] for line in rows])


def _piece(row: Table) -> Bend:
    if "line" in row.data:
        row.only("line")
        return Bend(row.positive("line"))
    row.only("arc", "radius", "towards")
    degrees, radius = row.positive("arc"), row.positive("radius")
    return Bend(math.radians(degrees) * radius, radius, row.vector("towards"))
