"""Compiled text of rows of numbers; see ``rows_kernel.c``."""

from libc.stddef cimport ptrdiff_t
from libc.stdint cimport int64_t, uint64_t

cdef extern from "rows_kernel.h":
    enum:
        MESHONET_INTEGER_BYTES
        MESHONET_FLOAT_BYTES
        MESHONET_LEAST_POWER
        MESHONET_MOST_POWER
    ctypedef struct power_of_ten:
        uint64_t high
        uint64_t low
        int exponent
    ctypedef struct row_form:
        const char *text
        const ptrdiff_t *at
        ptrdiff_t m
    ptrdiff_t integer_rows(char *out, const int64_t *rows, ptrdiff_t n, row_form form) nogil
    ptrdiff_t float_rows(char *out, const double *rows, ptrdiff_t n, row_form form, const power_of_ten *powers) nogil

INTEGER_BYTES = MESHONET_INTEGER_BYTES
FLOAT_BYTES = MESHONET_FLOAT_BYTES

cdef power_of_ten _powers[MESHONET_MOST_POWER - MESHONET_LEAST_POWER + 1]
cdef bint _known = False


cdef void _learn_powers() except *:
    """Fill the table of powers of ten by exact arithmetic, in half a millisecond."""
    global _known
    for k in range(MESHONET_MOST_POWER - MESHONET_LEAST_POWER + 1):
        n = k + MESHONET_LEAST_POWER
        if n >= 0:
            exponent = (10**n).bit_length() - 128
            value = 10**n >> exponent if exponent > 0 else 10**n << -exponent
        else:
            exponent = -((10**-n).bit_length() + 127)
            value = (1 << -exponent) // 10**-n
            if value.bit_length() > 128:
                value, exponent = value >> 1, exponent + 1
        _powers[k].high, _powers[k].low = value >> 64, value & 0xFFFFFFFFFFFFFFFF
        _powers[k].exponent = exponent
    _known = True


cdef row_form _form(bytes text, const ptrdiff_t[::1] at, Py_ssize_t m) except *:
    cdef row_form form
    if at.shape[0] != m + 2 or at[0] != 0 or at[m + 1] != len(text):
        raise ValueError("the pieces of text do not fit the rows")
    form.text, form.at, form.m = text, &at[0], m
    return form


def put_integers(char[::1] out, const int64_t[:, ::1] rows, bytes text, const ptrdiff_t[::1] at):
    """Write `rows` (n, m) to `out` and return the bytes written; piece k of `text` from `at[k]` on stands before number k."""
    cdef Py_ssize_t n = rows.shape[0], m = rows.shape[1], count
    cdef row_form form = _form(text, at, m)
    if n == 0:
        return 0
    if out.shape[0] < n * (m * MESHONET_INTEGER_BYTES + len(text)):
        raise ValueError("out is too small")
    with nogil:
        count = integer_rows(&out[0], &rows[0, 0], n, form)
    return count


def put_floats(char[::1] out, const double[:, ::1] rows, bytes text, const ptrdiff_t[::1] at):
    """Write `rows` (n, m) with 17 significant digits, as `put_integers` does."""
    cdef Py_ssize_t n = rows.shape[0], m = rows.shape[1], count
    cdef row_form form = _form(text, at, m)
    if n == 0:
        return 0
    if not _known:
        _learn_powers()
    if out.shape[0] < n * (m * MESHONET_FLOAT_BYTES + len(text)):
        raise ValueError("out is too small")
    with nogil:
        count = float_rows(&out[0], &rows[0, 0], n, form, _powers)
    return count
