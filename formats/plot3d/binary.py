"""Binary Plot3D files: C binary or Fortran records, either byte order, float32 or float64.

Both are streams of 4-byte integers, floating-point numbers, and iblank integers.
"""

import itertools

import numpy as np

from meshonet.formats.format import Options
from meshonet.formats.plot3d.layouts import MOST_INTEGERS, Candidate, FileLayout, layouts
from meshonet.formats.plot3d.stream import Stream, broken_record, unframed
from meshonet.geometry.errors import InputError

_LONGEST = 100_000  # largest node count along an index that is named in an error message as a possible header
_ORDERS = {"<": "little", ">": "big"}  # names of byte orders


def candidates(data: memoryview, wanted: Options = frozenset()) -> list[Candidate]:
    """Return all layouts for which a binary file would have the length of `data`.

    Layouts that store whole planes are included if `wanted` contains ``planes``, or if each Fortran record
    has one plane. Raises InputError if no layout fits.
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
    """Return the error for a file that no layout fits: the first broken record, or the nearest layout."""
    remedy = "the file is cut short, or is something else: name its format with {from_format}"
    for order in "<>":
        problem = broken_record(data, order)
        if problem:
            return InputError(problem, remedy)
    near = min(tried, default=None, key=lambda each: abs(each[0] - len(data)))
    shown = f" (nearest: {near[1]}, {near[0]} bytes)" if near else ""
    return InputError(f"has {len(data)} bytes and no binary Plot3D layout fits{shown}", remedy)


def _fitting(stream: Stream, order: str, wanted: Options, tried: list[tuple[int, str]]) -> list[Candidate]:
    """Return the layouts with the length of a stream; those tried are appended to `tried`."""
    count = min(len(stream) // 4, MOST_INTEGERS)
    integers = np.frombuffer(stream.take(0, 4 * count), np.dtype(order + "i4"))

    def integer(k: int) -> int | None:
        return int(integers[k]) if k < count else None

    fitting = []
    for layout, size in itertools.product(layouts(integer), (8, 4)):
        length = layout.length(size, 4)
        if length == len(stream):
            kind, name = ("fortran", "Fortran records") if stream.records else ("binary", "C binary")
            shown = f"{name}, {_ORDERS[order]} endian, float{8 * size}"
            traits = frozenset({kind, _ORDERS[order], f"float{8 * size}"})
            types = np.dtype(f"{order}f{size}"), np.dtype(f"{order}i4")
            fitting += [
                Candidate(layout, stream, *types, planes, shown, traits)
                for planes in _forms(stream, layout, wanted)
            ]
        elif 2 <= max(map(max, layout.dims)) <= _LONGEST and not layout.iblank:
            dims = ", ".join("x".join(map(str, each)) for each in layout.dims[:3])
            tried.append((length, f"dims {dims}, float{8 * size}, {_ORDERS[order]} endian"))
    return fitting


def _forms(stream: Stream, layout: FileLayout, wanted: Options) -> list[bool]:
    """Return the possible forms of a block's coordinates: whole (False), plane by plane (True)."""
    if layout.axes < 3:
        return [False]
    # a record for each plane of a single block; of three planes it may as well be one for each coordinate
    records = stream.records - (2 if layout.counted else 1)
    if len(layout.dims) == 1 and records == layout.dims[0][2] > 1:
        return [True, False] if records == 3 else [True]
    return [False, True] if "planes" in wanted else [False]
