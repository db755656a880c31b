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
    """Write `rows` (n, m) as text to the bytes `out`; return the number of bytes written.

    Piece k of `text`, from `at[k]` on, precedes number k; numbers have 17 significant digits.
    """
    cdef ptrdiff_t n, m, count, width
    cdef bint whole = rows.dtype.kind == "i"
    cdef row_form form
    n, m = rows.shape
    form.text, form.at, form.m = text, reads_starts(at, m + 1, len(text)), m
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


cdef extern from "formats/words.h":
    ptrdiff_t c_count_words "count_words"(const char *text, ptrdiff_t n) nogil
    ptrdiff_t c_take_numbers "take_numbers"(const char *text, ptrdiff_t n, double *out, ptrdiff_t room,
                                            ptrdiff_t *stop, const power_of_ten *powers) nogil


def count_words(text):
    """Return an upper bound of the number of words of free format in the bytes `text`."""
    cdef ptrdiff_t n = len(text), count
    cdef const char *of = <const char *>numbers(text, b"b", 1, (n,), False)
    with nogil:
        count = c_count_words(of, n)
    return count


def take_numbers(text, out):
    """Read words of the bytes `text` as numbers into `out` (n,); return their number and where the next word starts.

    It stops if `out` is full, at a word that is no number, and at a number that needs the slow exact conversion.
    """
    cdef ptrdiff_t n = len(text), room = len(out), stop = 0, count
    cdef const char *of = <const char *>numbers(text, b"b", 1, (n,), False)
    cdef double *to = <double *>numbers(out, b"d", 8, (room,), True)
    if not _known:
        _learn_powers()
    with nogil:
        count = c_take_numbers(of, n, to, room, &stop, _powers)
    return count, stop


cdef extern from "formats/faces.h":
    ctypedef struct cell_block:
        const int32_t *nodes
        const int32_t *beyond[6]
        ptrdiff_t ni
        ptrdiff_t nj
        ptrdiff_t nk
        int32_t first
    ctypedef struct face_lists:
        int32_t *nodes
        int32_t *owner
        int32_t *neighbour
        ptrdiff_t room
    ptrdiff_t c_inner_faces "inner_faces"(const cell_block *block, face_lists out) nogil


def inner_faces(nodes, beyond, int32_t first, faces, owner, neighbour):
    """Write the faces whose owner is a cell of a block, in upper-triangular order; return their number.

    `nodes` (nk+1, nj+1, ni+1) and `beyond`, one array for each side from west to top, are the numbers that ``faces.h``
    defines. `faces` (f, 4), `owner` (f,) and `neighbour` (f,) need room for six faces of each cell of one row more.
    """
    cdef cell_block block
    cdef face_lists out
    cdef ptrdiff_t count
    block.nk, block.nj, block.ni = (n - 1 for n in nodes.shape)
    block.nodes, block.first = <const int32_t *>numbers(nodes, b"i", 4, nodes.shape, False), first
    shapes = (block.nk, block.nj), (block.nk, block.ni), (block.nj, block.ni)
    for side in range(6):
        block.beyond[side] = <const int32_t *>numbers(beyond[side], b"i", 4, shapes[side // 2], False)
    out.room = len(owner)
    out.nodes = <int32_t *>numbers(faces, b"i", 4, (out.room, 4), True)
    out.owner = <int32_t *>numbers(owner, b"i", 4, (out.room,), True)
    out.neighbour = <int32_t *>numbers(neighbour, b"i", 4, (out.room,), True)
    with nogil:
        count = c_inner_faces(&block, out)
    if count < 0:
        raise ValueError("too little room for faces")
    return count
