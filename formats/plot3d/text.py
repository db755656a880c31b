"""Plot3D as text: free format, commas, repeat counts ``r*v`` (in the header too), Fortran ``D`` exponents."""

import re

import numpy as np

from meshonet.formats.format import Options
from meshonet.formats.plot3d.layouts import Candidate, FileLayout, layouts
from meshonet.formats.plot3d.stream import Stream
from meshonet.formats.text.number_table import leading_numbers, parsed
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError

_FREE_FORMAT = bytes.maketrans(b",;dDqQ\x1a\v\f", b"  eeee   ")
"""Conversion of Fortran's separators and exponent letters to those of C."""
_NUMBER = re.compile(rb"([+-]?(?:\d+\.?\d*|\.\d+))(?:e?([+-]\d{1,4})|e(\d{1,4}))?", re.IGNORECASE)
"""A number whose exponent may lack its letter."""
_MOST_NODES = 1e12  # largest plausible node count
_MOST_REPEATED = 4  # largest plausible number of values per byte of the file, with repeat counts expanded


def candidates(data: bytes, wanted: Options = frozenset()) -> list[Candidate]:
    """Return all layouts that agree with the count of numbers in a text file.

    Layouts that store whole planes are tried only if `wanted` has ``planes``. Raises InputError if none fits.
    """
    values = _numbers(data)

    def integer(k: int) -> int | None:
        number = float(values[k]) if k < len(values) else 0.5
        return int(number) if number.is_integer() and abs(number) < _MOST_NODES else None

    tried = list(layouts(integer))
    fitting = [layout for layout in tried if layout.length() == len(values)]
    if not fitting:
        raise _misfit(tried, len(values))
    stream, kind = Stream([values.data.cast("B")]), frozenset({"ascii"})
    return [
        Candidate(layout, stream, values.dtype, values.dtype, planes, "ASCII", kind)
        for planes in (False, True)
        for layout in fitting
        if not planes or ("planes" in wanted and layout.axes == 3)
    ]


def _misfit(tried: list[FileLayout], numbers: int) -> InputError:
    if not tried:
        return InputError(
            "does not start with the dims of a Plot3D grid",
            "start it with [count of blocks] ni nj [nk], or name another format with {from_format}",
        )
    plain = (layout for layout in tried if not layout.iblank)
    near = min(plain, key=lambda layout: abs(layout.length() - numbers))
    dims = ", ".join("x".join(map(str, dims)) for dims in near.dims[:3])
    return InputError(
        f"has {numbers} numbers and no Plot3D layout fits (nearest: dims {dims}, {near.length()} numbers)",
        "the file is cut short or its dims are wrong: write it again",
    )


def _numbers(data: bytes) -> Floats:
    """Return all numbers of the file, with repeat counts expanded."""
    values, stop = leading_numbers(data)
    if stop == len(data):
        return values
    plain = data.translate(_FREE_FORMAT)
    counts = None
    if b"*" in plain:
        plain, counts = _repeats(plain)
        if int(counts.sum()) > _MOST_REPEATED * len(data):
            raise InputError("repeats a number too often for its size", "write the values out")
    every = parsed(plain)
    if every is None:
        every = parsed(b" ".join(_spelled(word, data) for word in plain.split()))
    if every is None:
        raise InputError("has a word that is not a number", "write numbers only")
    return every if counts is None else np.repeat(every, counts)


def _repeats(text: bytes) -> tuple[bytes, np.ndarray[tuple[int], np.dtype[np.int64]]]:
    """Return `text` with every ``r*v`` replaced by ``v``, and the count of each word."""
    words = text.split()
    counts = np.ones(len(words), np.int64)
    for k, word in enumerate(words):
        if b"*" in word:
            times, _, value = word.partition(b"*")
            if not times.isdigit() or len(times) > 12 or not value:
                raise _not_a_number(word, text)
            counts[k], words[k] = int(times), value
    return b" ".join(words), counts


def _spelled(word: bytes, data: bytes) -> bytes:
    """Return `word` with the exponent letter that Fortran may omit, as in 0.1234-102."""
    match = _NUMBER.fullmatch(word)
    if match is None:
        raise _not_a_number(word, data)
    mantissa, signed, unsigned = match.groups()
    return mantissa + b"e" + (signed or unsigned or b"0")


def _not_a_number(word: bytes, data: bytes) -> InputError:
    line = data[: max(data.translate(_FREE_FORMAT).find(word), 0)].count(b"\n") + 1
    if not word.isascii():
        remedy = "name its format with {from_format}, or give a Plot3D file"
        return InputError("holds binary data beside text", remedy, place=f"line {line}")
    shown = word[:40].decode("ascii")
    return InputError(
        f"{shown!r} is not a number",
        "write numbers only, or name another format with {from_format}",
        place=f"line {line}",
    )
