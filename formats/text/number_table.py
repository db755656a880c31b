"""Rows of numbers as text, many at a time: what mesh files of solvers mostly consist of."""

from __future__ import annotations

from itertools import accumulate
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from meshonet.kernels._native import FLOAT_BYTES, INTEGER_BYTES, put_rows

_ROWS = 1 << 13
"""Rows turned into text at a time: their text stays in the second-level cache."""


def write_rows(stream: BinaryIO, form: str, rows: NDArray[Any]) -> None:
    r"""Write every row of `rows` (n, m), its numbers in the places of the fields of `form`, and a line end.

    Parameters
    ----------
    form : m fields ``%d`` for whole numbers, or ``%e`` for floats with 17 significant digits; no line end.
    rows : (n, m).

    Examples
    --------
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
