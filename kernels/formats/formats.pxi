cdef extern from "formats/rows.h":
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
    ptrdiff_t c_put_rows "put_rows"(char *out, const void *rows, ptrdiff_t n, row_form form,
                                    const power_of_ten *powers) nogil

INTEGER_BYTES = MESHONET_INTEGER_BYTES
FLOAT_BYTES = MESHONET_FLOAT_BYTES

cdef power_of_ten _powers[MESHONET_MOST_POWER - MESHONET_LEAST_POWER + 1]
cdef bint _known = False


cdef int _learn_powers() except -1:
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
    return 0


def put_rows(out, rows, bytes text, at):
    """Write `rows` (n, m) to the bytes `out` and return how many were written.

    Piece k of `text`, from `at[k]` on, stands before number k; floats have 17 significant digits.
    """
    cdef ptrdiff_t n, m, count, width
    cdef bint whole = rows.dtype.kind == "i"
    cdef row_form form
    n, m = rows.shape
    form.text, form.at, form.m = text, reads_indices(at, (m + 2,)), m
    if form.at[0] != 0 or form.at[m + 1] != len(text):
        raise ValueError("the pieces of text do not fit the rows")
    if n == 0:
        return 0
    width = MESHONET_INTEGER_BYTES if whole else MESHONET_FLOAT_BYTES
    if len(out) < n * (m * width + len(text)):
        raise ValueError("out is too small")
    cdef char *to = <char *>numbers(out, b"b", 1, out.shape, True)
    cdef const void *values = numbers(rows, b"i" if whole else b"d", 8, (n, m), False)
    cdef const power_of_ten *powers = NULL
    if not whole:
        if not _known:
            _learn_powers()
        powers = _powers
    with nogil:
        count = c_put_rows(to, values, n, form, powers)
    return count
