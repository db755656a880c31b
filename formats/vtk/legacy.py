"""Legacy VTK structured grids, ``.vtk``, binary (big endian) or text, with or without field data.

https://docs.vtk.org/en/latest/vtk_file_formats/vtk_legacy_file_format.html
"""

import re
from collections.abc import Iterable, Iterator
from mmap import mmap
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import Options, only_one
from meshonet.formats.mesh.metadata import facts_of
from meshonet.formats.mesh.structured import grid_of_block
from meshonet.formats.source import Source, printable
from meshonet.formats.text.number_table import leading_numbers, write_rows
from meshonet.formats.vtk import points_of
from meshonet.formats.vtk.arrays import CUT
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

_KINDS = {
    "double": "f8", "float": "f4", "int": "i4", "unsigned_int": "u4", "long": "i8", "unsigned_long": "u8",
    "vtktypeint64": "i8", "vtkidtype": "i8",
    "short": "i2", "unsigned_short": "u2", "char": "i1", "unsigned_char": "u1",
}  # fmt: skip
"""NumPy's number types by the type names of legacy files, in lower case."""
_LINE = 4096  # largest number of bytes that are read as one line
_WORD = re.compile(rb"\S")  # start of the next line that is not blank


def write_grids(path: Path, grids: Iterable[Grid], *, options: Options = frozenset()) -> None:
    """Write the only grid of `grids`, which must have one block, as legacy VTK."""
    grid, text = only_one(grids, "a .vtk file"), "ascii" in options
    ni, nj, nk = (*grid.blocks[0].counts, 1)[:3]
    with path.open("wb") as stream:
        form = "ASCII" if text else "BINARY"
        head = f"# vtk DataFile Version 3.0\nstructured grid\n{form}\nDATASET STRUCTURED_GRID\n"
        stream.write(head.encode())
        _write_facts(stream, grid, text=text)
        stream.write(f"DIMENSIONS {ni} {nj} {nk}\n".encode())
        stream.write(f"POINTS {ni * nj * nk} double\n".encode())
        for points in points_of(grid.nodes, ">f8"):
            if text:
                write_rows(stream, "%e %e %e", points)
            else:
                stream.write(points.data)
        stream.write(b"\n")


def _write_facts(stream: BinaryIO, grid: Grid, *, text: bool) -> None:
    """Write topology, name and patches as a FIELD of bytes; meshio cannot read string fields."""
    facts = {name: "\n".join(texts).encode() for name, texts in facts_of(grid).items()}
    stream.write(f"FIELD FieldData {len(facts)}\n".encode())
    for name, codes in facts.items():
        stream.write(f"{name} 1 {len(codes)} unsigned_char\n".encode())
        stream.write(" ".join(map(str, codes)).encode() if text else codes)
        stream.write(b"\n")


class _Cursor:
    """Reads bytes sequentially."""

    def __init__(self, data: bytes | mmap) -> None:
        self.data, self.at = data, 0

    def line(self) -> str:
        """Return the next line that is not blank, without its end."""
        start = _WORD.search(self.data, self.at)
        if start is None:
            raise InputError("ends before its points", CUT)
        end = self.data.find(b"\n", start.start(), start.start() + _LINE)
        end = end if end >= 0 else min(start.start() + _LINE, len(self.data))
        self.at = end + 1
        return self.data[start.start() : end].decode("latin-1").strip()

    def words(self, count: int) -> list[bytes]:
        """Return the next `count` blank-separated words."""
        if 2 * count - 1 > len(self.data) - self.at:
            raise InputError(f"should have {count} more numbers and is too short", CUT)
        rest = self.data[self.at :].split(None, count)
        if len(rest) < count:
            raise InputError(f"should have {count} more numbers and has {len(rest)}", CUT)
        self.at = len(self.data) - len(rest[count]) if len(rest) > count else len(self.data)
        return rest[:count]

    def numbers(self, count: int) -> Floats:
        """Return the next `count` numbers."""
        values, stop = leading_numbers(self.data, count, self.at)
        if len(values) < count:
            return np.array(self.words(count), dtype=np.float64)
        self.at = stop
        return values

    def bytes(self, count: int) -> memoryview:
        """Return a view of the next `count` bytes."""
        if count > len(self.data) - self.at:
            raise InputError(f"should have {count} more bytes and is too short", CUT)
        self.at += count
        return memoryview(self.data)[self.at - count : self.at]


def read_grids(source: Source) -> Iterator[Grid]:
    """Yield the grid of a legacy VTK file. Raises InputError if it is no STRUCTURED_GRID or is damaged."""
    cursor = _Cursor(source.buffer())
    try:
        coordinates, facts = _read(cursor)
    except (ValueError, OverflowError, IndexError) as error:
        problem = printable(str(error))[:100]
        raise InputError(problem, "write the file again", place=f"byte {cursor.at}") from None
    except InputError as error:
        error.place = error.place or f"byte {cursor.at}"
        raise
    yield grid_of_block(coordinates, facts, source.stem)


def _read(cursor: _Cursor) -> tuple[list[Floats], dict[str, list[str]]]:
    if not cursor.line().startswith("# vtk DataFile"):
        raise InputError("does not start with '# vtk DataFile'", "give a legacy VTK file")
    cursor.at = cursor.data.find(b"\n", cursor.at) + 1  # the title, which may be blank
    text = cursor.line().upper() == "ASCII"
    dataset = cursor.line().split()
    if [word.upper() for word in dataset] != ["DATASET", "STRUCTURED_GRID"]:
        raise InputError(f"holds {' '.join(dataset)[:60]!r}", "give a DATASET STRUCTURED_GRID")
    facts: dict[str, list[str]] = {}
    dims = (0, 0, 0)
    while True:
        words = cursor.line().split()
        key = words[0].upper()
        if key == "DIMENSIONS":
            dims = (int(words[1]), int(words[2]), int(words[3]))
        elif key == "FIELD":
            facts |= _field(cursor, int(words[2]), text=text)
        elif key == "POINTS":
            break
    if min(dims) < 1 or dims[0] * dims[1] * dims[2] != int(words[1]):
        shown = "x".join(map(str, dims))[:60]
        raise InputError(f"has {words[1][:20]!r} points and DIMENSIONS {shown}", "make them agree")
    points = _numbers(cursor, words[2], 3 * int(words[1]), text=text).reshape(*dims[::-1], 3)
    return [points[..., k].T for k in range(3)], facts


def _field(cursor: _Cursor, count: int, *, text: bool) -> dict[str, list[str]]:
    """Return the texts of a FIELD, strings or UTF-8 bytes; numbers are skipped."""
    facts: dict[str, list[str]] = {}
    for _ in range(count):
        name, components, tuples, kind = cursor.line().split()
        total = int(components) * int(tuples)
        if not 0 <= total <= len(cursor.data):
            raise InputError(f"field {name[:40]!r} claims {total} values", "write the file again")
        if kind.lower() != "string":
            codes = _numbers(cursor, kind, total, text=text)
            if kind.lower() == "unsigned_char":
                with np.errstate(invalid="ignore"):  # text may hold NaN here, which then is no name
                    facts[name] = codes.astype(np.uint8).tobytes().decode("utf-8", "replace").split("\n")
        elif text:
            facts[name] = [unquote(_raw_line(cursor)) for _ in range(total)]
        else:
            facts[name] = [_counted(cursor).tobytes().decode("utf-8", "replace") for _ in range(total)]
    return facts


def _numbers(cursor: _Cursor, kind: str, count: int, *, text: bool) -> NDArray[Any]:
    if kind.lower() not in _KINDS:
        raise InputError(f"number type {kind[:40]!r} is not known", "write double or float")
    if text:
        return cursor.numbers(count)
    dtype = np.dtype(">" + _KINDS[kind.lower()])
    return np.frombuffer(cursor.bytes(count * dtype.itemsize), dtype)


def _raw_line(cursor: _Cursor) -> str:
    """Return the next line, which may be blank."""
    end = cursor.data.find(b"\n", cursor.at)
    start, cursor.at = cursor.at, (end if end >= 0 else len(cursor.data)) + 1
    return cursor.data[start : cursor.at - 1].decode("latin-1").strip()


def _counted(cursor: _Cursor) -> memoryview:
    """Return a string after its length, of 1, 2, 4 or 8 bytes as the first two bits say."""
    first = cursor.bytes(1)
    width = {3: 1, 2: 2, 1: 4, 0: 8}[first[0] >> 6]
    length = int.from_bytes(bytes(first) + cursor.bytes(width - 1), "big") & ((1 << (8 * width - 2)) - 1)
    return cursor.bytes(length)
