cdef extern from "rows/span.h":
    void c_chebyshev_sums "chebyshev_sums"(const double *c, ptrdiff_t terms, ptrdiff_t n, const double *heights,
                                           ptrdiff_t levels, ptrdiff_t lines, double *out) nogil

cdef extern from "rows/channel.h":
    int CHANNEL_COLUMNS, CHANNEL_LEVELS
    ctypedef struct Channel:
        Read cubics, levels
        ptrdiff_t pieces, count
    void c_channel_points "channel_points"(const Channel *channel, const double *s, const double *h, ptrdiff_t n,
                                           double *points) nogil
    void c_channel_space "channel_space"(const Channel *channel, const double *values, ptrdiff_t n,
                                         double *space) nogil


def chebyshev_sums(coefficients, heights, out):
    """Fill `out` (levels, n) with sums of `coefficients` (terms, n) times Chebyshev polynomials at `heights` (levels, lines).

    Heights are from 0 to 1; each is that of n / lines functions in a row.
    """
    cdef ptrdiff_t terms, n, levels, lines
    terms, n = coefficients.shape
    levels, lines = heights.shape
    if terms < 2 or (n and not (lines and n % lines == 0)):
        raise ValueError(f"{terms} terms of {n} functions at heights of {lines} lines")
    cdef Read c = reads(coefficients, (terms, n)), h = reads(heights, (levels, lines))
    cdef Written to = fills(out, (levels, n))
    with nogil:
        c_chebyshev_sums(c, terms, n, h, levels, lines, to)


cdef Channel channel_of(tuple tables) except *:
    """Return the channel of tables: cubics (pieces, 4, CHANNEL_COLUMNS), levels."""
    cubics, levels = tables
    cdef ptrdiff_t count = len(levels)
    if not (2 <= count <= CHANNEL_LEVELS and len(cubics)):
        raise ValueError(f"a channel of {len(cubics)} pieces and {count} levels")
    return Channel(reads(cubics, (len(cubics), 4, CHANNEL_COLUMNS)), reads(levels, (count,)), len(cubics), count)


def channel_points(tuple tables, s, h, points):
    """Fill `points` (n, 2) with x, r of `s` (n,) and `h` (n,); `tables` are those of ``channel.h``."""
    cdef Channel channel = channel_of(tables)
    cdef ptrdiff_t n = len(s)
    cdef Read ps = reads(s, (n,)), ph = reads(h, (n,))
    cdef Written to = fills(points, (n, 2))
    with nogil:
        c_channel_points(&channel, ps, ph, n, to)


def channel_space(tuple tables, values, space):
    """Fill `space` (n, 3) with x, y, z of s, theta, h, `values` (n, 3)."""
    cdef Channel channel = channel_of(tables)
    cdef ptrdiff_t n = len(values)
    cdef Read v = reads(values, (n, 3))
    cdef Written to = fills(space, (n, 3))
    with nogil:
        c_channel_space(&channel, v, n, to)
