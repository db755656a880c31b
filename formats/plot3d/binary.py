"""Plot3D as bytes: C binary or Fortran records, either byte order, float32 or float64.

Once the lengths of records are taken away, both kinds are the same stream: integers of 4 bytes, then floats,
then the integers of iblank.
"""

import itertools
from collections.abc import Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.format import Options
from meshonet.formats.plot3d.layouts import MOST_INTEGERS, Candidate, Layout, layouts
from meshonet.formats.plot3d.stream import Stream, broken_record, unframed
from meshonet.geometry.errors import InputError

_LONGEST = 100_000
_ORDERS = {"<": "little", ">": "big"}


def candidates(data: memoryview, wanted: Options = frozenset()) -> list[Candidate]:
    """Return every layout whose length in bytes is exactly the file's; planes only if they are `wanted`.

    Fortran records that are one a plane say themselves that they are.

    Raises InputError: no layout is.
    """
    fitting: list[Candidate] = []
    tried: list[tuple[int, str]] = []
    for order in "<>":
        stream = unframed(data, order)
        if stream is not None:
            fitting += _fitting(stream, order, wanted, tried)
    if fitting:
        return fitting
    for order in "<>":
        fitting += _fitting(Stream([data]), order, wanted, tried)
    if not fitting:
        raise _misfit(data, tried)
    return fitting


def _misfit(data: memoryview, tried: list[tuple[int, str]]) -> InputError:
    """Return what is wrong with a file that no layout fits: where its records break, or what is nearest."""
    remedy = "the file is cut short, or is something else: name its format with {from_format}"
    for order in "<>":
        problem = broken_record(data, order)
        if problem:
            return InputError(problem, remedy)
    near = min(tried, default=None, key=lambda each: abs(each[0] - len(data)))
    shown = f" (nearest: {near[1]}, {near[0]} bytes)" if near else ""
    return InputError(f"has {len(data)} bytes and no binary Plot3D layout fits{shown}", remedy)


def _fitting(stream: Stream, order: str, wanted: Options, tried: list[tuple[int, str]]) -> list[Candidate]:
    """Return the layouts of a stream's length; adds to `tried` lengths and names of those of its header."""
    count = min(len(stream) // 4, MOST_INTEGERS)
    integers = np.frombuffer(stream.take(0, 4 * count), np.dtype(order + "i4"))

    def integer(k: int) -> int | None:
        return int(integers[k]) if k < count else None

    fitting = []
    for layout, size in itertools.product(layouts(integer), (8, 4)):
        length = layout.length(size, 4)
        if length == len(stream):
            forms = [_Form(stream, layout, order, size, planes) for planes in _forms(stream, layout, wanted)]
            fitting += [form.candidate() for form in forms]
        elif 2 <= max(map(max, layout.dims)) <= _LONGEST and not layout.iblank:
            dims = ", ".join("x".join(map(str, each)) for each in layout.dims[:3])
            tried.append((length, f"dims {dims}, float{8 * size}, {_ORDERS[order]} endian"))
    return fitting


def _forms(stream: Stream, layout: Layout, wanted: Options) -> list[bool]:
    """Return whether the coordinates of a block may stand whole (False), or plane by plane (True)."""
    if layout.axes < 3:
        return [False]
    # a record for each plane of a single block; of three planes it may as well be one for each coordinate
    records = stream.records - (2 if layout.counted else 1)
    if len(layout.dims) == 1 and records == layout.dims[0][2] > 1:
        return [True, False] if records == 3 else [True]
    return [False, True] if "planes" in wanted else [False]


class _Form:
    """One way to read a stream."""

    def __init__(self, stream: Stream, layout: Layout, order: str, size: int, planes: bool) -> None:
        self._stream, self._layout, self._order, self._planes = stream, layout, order, planes
        self._dtype, self._starts = np.dtype(f"{order}f{size}"), layout.starts(size, 4)

    def candidate(self) -> Candidate:
        """Return it with its names."""
        kind, name = ("fortran", "Fortran records") if self._stream.records else ("binary", "C binary")
        order, real = _ORDERS[self._order], f"float{8 * self._dtype.itemsize}"
        words = f"{name}, {order} endian, {real}"
        traits = {kind, order, real, "planes" if self._planes else "whole"}
        return Candidate(self._layout, self.coordinates, self.flags, words, frozenset(traits))

    def coordinates(self, k: int) -> Sequence[NDArray[Any]]:
        """Return the coordinates of block k, flat, in the file's own number type; views of whole ones."""
        count, axes = prod(self._layout.dims[k]), self._layout.axes
        if not self._planes:
            size = count * self._dtype.itemsize
            return [self._numbers(self._starts[k] + axis * size, count) for axis in range(axes)]
        planes = self._layout.dims[k][2]
        rows = [self._numbers(at, axes * count // planes).reshape(axes, -1) for at in self._plane_starts(k)]
        return [np.concatenate([row[axis] for row in rows]) for axis in range(axes)]

    def flags(self, k: int) -> NDArray[Any]:
        """Return the iblank array of block k, flat."""
        count, axes = prod(self._layout.dims[k]), self._layout.axes
        starts = self._plane_starts(k) if self._planes else [self._starts[k]]
        part = count // len(starts)
        behind = axes * part * self._dtype.itemsize
        kind = self._order + "i4"
        flags = [np.frombuffer(self._stream.take(at + behind, 4 * part), kind) for at in starts]
        return flags[0] if len(flags) == 1 else np.concatenate(flags)

    def _plane_starts(self, k: int) -> list[int]:
        """Return where the planes of block k start."""
        size = self._starts[k + 1] - self._starts[k]
        planes = self._layout.dims[k][2]
        return [self._starts[k] + plane * (size // planes) for plane in range(planes)]

    def _numbers(self, at: int, count: int) -> NDArray[Any]:
        return np.frombuffer(self._stream.take(at, count * self._dtype.itemsize), self._dtype)
