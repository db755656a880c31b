"""Compiled conversion of tables of numbers to and from text, some ten times as fast as Python's."""

import warnings
from itertools import accumulate
from mmap import mmap
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import FLOAT_BYTES, INTEGER_BYTES, count_words, put_rows, take_numbers

_ROWS = 1 << 13  # number of rows converted at a time, so that their text stays in the second-level cache


def write_rows(stream: BinaryIO, form: str, rows: NDArray[Any]) -> None:
    r"""Write each row of `rows` (n, m) as a line of the format `form`.

    The format has m fields: ``%d`` for integers, or ``%e`` for floats, which get 17 significant digits.

    >>> from io import BytesIO
    >>> stream = BytesIO()
    >>> write_rows(stream, "4(%d %d)", np.array([[1, 20], [3, -4]]))
    >>> write_rows(stream, "%e;", np.array([[0.1]]))
    >>> stream.getvalue()
    b'4(1 20)\n4(3 -4)\n1.0000000000000001e-01;\n'
    """
    field = "%e" if "%e" in form else "%d"
    pieces = [piece.encode("ascii") for piece in f"{form}\n".split(field)]
    text, at = b"".join(pieces), np.array([0, *accumulate(map(len, pieces))], np.intp)
    dtype, width = (np.float64, FLOAT_BYTES) if field == "%e" else (np.int64, INTEGER_BYTES)
    buffer = np.empty(min(_ROWS, len(rows)) * (rows.shape[1] * width + len(text)), np.int8)
    for start in range(0, len(rows), _ROWS):
        part = np.ascontiguousarray(rows[start : start + _ROWS], dtype)
        stream.write(buffer[: put_rows(buffer, part, text, at)].data)


def parsed(text: bytes) -> Floats | None:
    """Return the numbers in a text of numbers and blanks; None if it contains anything else.

    >>> parsed(b"1 2.5 -3e2").tolist(), parsed(b"1 two")
    ([1.0, 2.5, -300.0], None)
    """
    with warnings.catch_warnings():
        # numpy announces text it cannot parse by a DeprecationWarning that is to become a ValueError
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, dtype=np.float64, sep=" ") if text.strip() else np.empty(0)
        except (DeprecationWarning, ValueError):
            return None


def leading_numbers(text: bytes | mmap, most: int | None = None, start: int = 0) -> tuple[Floats, int]:
    """Return at most `most` numbers of `text` from byte `start` on, and the position after the last of them.

    The numbers are in Fortran's free format. Reading ends at a word that is no number, is not finite, is
    subnormal or has a repeat count (``3*1.0``).

    >>> values, stop = leading_numbers(b"1 2.5, -3d2 0.4-101 end")
    >>> values.tolist(), stop
    ([1.0, 2.5, -300.0, 4e-102], 20)
    """
    if start >= len(text):
        return np.empty(0), len(text)
    part = np.frombuffer(text, np.int8, offset=start)
    room = count_words(part) if most is None else min(most, len(part))
    values = np.empty(room)
    count, stop = take_numbers(part, values)
    return values[:count], start + stop
