cdef extern from "rows/span.h":
    void c_chebyshev_sums "chebyshev_sums"(const double *c, ptrdiff_t terms, ptrdiff_t n, const double *heights,
                                           ptrdiff_t levels, ptrdiff_t lines, double *out) nogil
    void c_way_ahead "way_ahead"(const double *behind, const double *slope, const double *keys, ptrdiff_t count, ptrdiff_t n,
                                 double *parts) nogil
    void c_stacked_block "stacked_block"(const double *nodes, ptrdiff_t levels, ptrdiff_t count, const ptrdiff_t *ids,
                                         ptrdiff_t n, double *block) nogil

cdef extern from "rows/channel.h":
    int CHANNEL_COLUMNS, CHANNEL_LEVELS
    ctypedef struct Channel:
        Read cubics, levels
        ptrdiff_t pieces, count
    void c_channel_points "channel_points"(const Channel *channel, const double *s, const double *h, ptrdiff_t n,
                                           double *points) nogil
    void c_channel_space "channel_space"(const Channel *channel, const double *values, ptrdiff_t n,
                                         double *space) nogil
    void c_channel_nodes "channel_nodes"(const Channel *channel, const double *values, const ptrdiff_t *ids, ptrdiff_t levels,
                                         ptrdiff_t n, ptrdiff_t nodes, double *space) nogil

cdef extern from "rows/blade.h":
    ctypedef struct Splines:
        Read values, bends, knots
        ptrdiff_t count, n
    void c_spline_crossings "spline_crossings"(const Splines *splines, const double *heights, ptrdiff_t levels,
                                               double *points) nogil
    void c_columns_on_blade "columns_on_blade"(const Channel *channel, const double *wall, double first, ptrdiff_t n,
                                               ptrdiff_t rows, double *columns) nogil
    void c_lengthen_cells "lengthen_cells"(const Channel *channel, const double *begin, const double *sizes, ptrdiff_t n,
                                           double *end) nogil


def chebyshev_sums(coefficients, heights, out):
    """Fill `out` (levels, n) with sums of `coefficients` (terms, n) times Chebyshev polynomials at `heights` (levels, lines).

    Heights are from 0 to 1; each applies to n / lines consecutive functions.
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


def way_ahead(behind, slope, keys, parts):
    """Fill `parts` (k, n) from coefficients `behind` and `slope` (k, n) at `keys` (k,); see ``span.h``."""
    cdef ptrdiff_t count, n
    count, n = parts.shape
    if count < 2:
        raise ValueError("lines at fewer than 2 heights")
    cdef Read b = reads(behind, (count, n)), s = reads(slope, (count, n)), k = reads(keys, (count,))
    cdef Written to = fills(parts, (count, n))
    with nogil:
        c_way_ahead(b, s, k, count, n, to)


def stacked_block(nodes, ids, block):
    """Fill `block` (3, n, levels) with those of `nodes` (levels, m, 3) that have the numbers `ids` (n,)."""
    cdef ptrdiff_t levels = nodes.shape[0], count = nodes.shape[1], n = len(ids)
    cdef Read from_ = reads(nodes, (levels, count, 3))
    cdef const ptrdiff_t *numbers_ = reads_places(ids, (n,), count)
    cdef Written to = fills(block, (3, n, levels))
    with nogil:
        c_stacked_block(from_, levels, count, numbers_, n, to)


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


def channel_nodes(tuple tables, values, ids, space):
    """Fill nodes `ids` (m,) of all levels of `space` (levels, n, 3) with x, y, z of s, theta, h, `values` (levels, m, 3)."""
    cdef Channel channel = channel_of(tables)
    cdef ptrdiff_t levels = space.shape[0], n = space.shape[1], m = len(ids)
    cdef Read v = reads(values, (levels, m, 3))
    cdef const ptrdiff_t *places = reads_places(ids, (m,), n)
    cdef Written to = fills(space, (levels, n, 3))
    with nogil:
        c_channel_nodes(&channel, v, places, levels, m, n, to)


def spline_crossings(values, bends, knots, heights, points):
    """Fill `points` (levels, n, 2) with s, theta at `heights` (levels, n) of splines (k, n, 3) of s, theta, h by `knots` (k,)."""
    cdef ptrdiff_t count = len(knots), levels, n
    levels, n = heights.shape
    if count < 2:
        raise ValueError("splines through fewer than 2 knots")
    cdef Splines splines = Splines(
        reads(values, (count, n, 3)), reads(bends, (count, n, 3)), reads(knots, (count,)), count, n)
    cdef Read h = reads(heights, (levels, n))
    cdef Written to = fills(points, (levels, n, 2))
    with nogil:
        c_spline_crossings(&splines, h, levels, to)


def columns_on_blade(tuple tables, wall, double first, columns):
    """Put `columns` (n, rows, 3) of s, theta, h on the blade at `wall` (n, 2), first cells `first` high; see ``blade.h``."""
    cdef Channel channel = channel_of(tables)
    cdef ptrdiff_t n = columns.shape[0], rows = columns.shape[1]
    if rows < 2:
        raise ValueError("columns of one node")
    cdef Read w = reads(wall, (n, 2))
    cdef Written to = fills(columns, (n, rows, 3))
    with nogil:
        c_columns_on_blade(&channel, w, first, n, rows, to)


def lengthen_cells(tuple tables, begin, sizes, end):
    """Move `end` (n, 3), s, theta, h, to the distances `sizes` (n,) in space from `begin` (n, 3)."""
    cdef Channel channel = channel_of(tables)
    cdef ptrdiff_t n = len(end)
    cdef Read b = reads(begin, (n, 3)), s = reads(sizes, (n,))
    cdef Written to = fills(end, (n, 3))
    with nogil:
        c_lengthen_cells(&channel, b, s, n, to)
