"""Paths in space for sweeping: points x, y, z, one per line, or lines and arcs in TOML.

::

    start = [0, 0, 0]          # first point of the path; optional
    direction = [1, 0, 0]      # direction at the first point; optional

    [[pieces]]
    line = 2.0                 # length

    [[pieces]]
    arc = 90                   # degrees
    radius = 1.5
    towards = [0, 1, 0]        # direction in which the arc bends

A path through points is a smooth curve; it is closed if its last point equals the first.
"""

import math

import numpy as np

from meshonet.formats.source import Source, open_source
from meshonet.formats.text.rows import decode, read_lines, table
from meshonet.formats.toml_table import Table, toml_table
from meshonet.geometry.arrays import Floats
from meshonet.geometry.curves.path import Bend, Path, PiecedPath, SplinePath
from meshonet.geometry.errors import InputError, in_source

MOST_POINTS = 100_000
"""Largest number of points; a longer path is taken for a mistake."""


def path_of(text: str) -> Path:
    """Return the path of a file, or of standard input for ``-``; the extension determines whether it is TOML.

    Raises InputError, with the place: the file cannot be read; a line does not have three numbers; a key is
    unknown; a value is invalid.
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
