"""Plot3D as bytes: C binary or Fortran records, either byte order, float32 or float64.

Fortran frames each record with its length before and after. Once the frames are taken away, both kinds
are the same stream: integers of 4 bytes, then floats, then the integers of iblank.
"""

import itertools
import struct
from collections.abc import Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.plot3d.layouts import Candidate, Layout, layouts
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError

_MOST_RECORDS = 400_000
_NAMES = {"<": "little endian", ">": "big endian"}


def candidates(data: bytes) -> list[Candidate]:
    """Return every layout whose length in bytes is exactly the file's.

    Raises InputError: none is.
    """
    fitting: list[Candidate] = []
    tried: list[str] = []
    for order in "<>":
        records = _unframed(data, order)
        if records is not None:
            fitting += _fitting(b"".join(records), order, "Fortran records", len(records), tried)
    if fitting:
        return fitting
    for order in "<>":
        fitting += _fitting(data, order, "C binary", 0, tried)
    if not fitting:
        near = f" (a header could be dims {', '.join(tried[:3])})" if tried else ""
        raise InputError(
            f"has {len(data)} bytes and no binary Plot3D layout fits{near}",
            "the file is cut short, or is something else: name its format with {from_format}",
        )
    return fitting


def _fitting(stream: bytes, order: str, numbers: str, records: int, tried: list[str]) -> list[Candidate]:
    integers = np.frombuffer(stream, np.dtype(order + "i4"), len(stream) // 4)

    def integer(k: int) -> int | None:
        return int(integers[k]) if k < len(integers) else None

    fitting = []
    for layout, size in itertools.product(layouts(integer), (8, 4)):
        if layout.length(size, 4) == len(stream):
            words = f"{numbers}, {_NAMES[order]}, float{8 * size}"
            fitting.append(_candidate(layout, stream, np.dtype(f"{order}f{size}"), words, records))
        elif 2 <= max(map(max, layout.dims)) <= 100_000 and not layout.iblank and size == 8:
            tried.append("x".join(map(str, layout.dims[0])))
    return fitting


def _candidate(layout: Layout, stream: bytes, dtype: np.dtype[Any], numbers: str, records: int) -> Candidate:
    starts = layout.starts(dtype.itemsize, 4)
    # one record a plane, x y z of each plane together: the "planes" form, which matters for two planes
    headers = 2 if layout.counted else 1
    by_planes = layout.axes == 3 and len(layout.dims) == 1 and layout.dims[0][2] == 2 == records - headers

    def block(k: int) -> Sequence[Floats]:
        nodes, at = prod(layout.dims[k]), starts[k]
        values: NDArray[Any] = np.frombuffer(stream, dtype, layout.axes * nodes, at)
        rows = values.reshape(layout.axes, -1)
        if by_planes:
            rows = values.reshape(2, 3, -1).swapaxes(0, 1).reshape(3, -1)
        with np.errstate(invalid="ignore"):  # a wrong reading meets signalling NaN
            arrays = list(rows.astype(np.float64))
        if layout.iblank:
            flags = np.frombuffer(stream, dtype.byteorder + "i4", nodes, at + values.nbytes)
            arrays.append(flags.astype(np.float64))
        return arrays

    kind = {
        "fortran" if records else "binary",
        "big" if ", big" in numbers else "little",
        f"float{8 * dtype.itemsize}",
        "planes" if by_planes else "whole",
    }
    return Candidate(layout, block, numbers, frozenset(kind))


def _unframed(data: bytes, order: str) -> list[memoryview] | None:
    """Return the records of a Fortran file, or None when the length words do not lead to its end.

    gfortran splits a record of more than 2 GiB: a negative first word says that more follows.
    """
    view, at = memoryview(data), 0
    records: list[memoryview] = []
    word = struct.Struct(order + "i")
    while at < len(view):
        if at + 8 > len(view) or len(records) == _MOST_RECORDS:
            return None
        length = abs(word.unpack_from(view, at)[0])
        end = at + 4 + length
        if not length or end + 4 > len(view) or abs(word.unpack_from(view, end)[0]) != length:
            return None
        records.append(view[at + 4 : end])
        at = end + 4
    return records or None
