cdef extern from "geometry/cells.h":
    int METRICS
    ctypedef struct CellRun:
        int periodic
        ptrdiff_t wake
        double *summary
        int64_t *where
        ptrdiff_t keep, n_kept
        double *kept
    ptrdiff_t cells_folded(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, int threads) nogil
    void cells_places(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, int64_t *pairs,
                      ptrdiff_t room) nogil
    size_t cells_scratch(ptrdiff_t ni, ptrdiff_t nj, int threads) nogil
    void cells_run(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const CellRun *run, int threads,
                   double *scratch) nogil

cdef extern from "geometry/curve.h":
    ctypedef struct ArcLengths:
        Read table, start, stop
        ptrdiff_t n, pieces
        int closed
    void c_curve_locate "curve_locate"(const ArcLengths *curve, const double *s, ptrdiff_t m, ptrdiff_t *interval,
                                       double *place) nogil
    void c_curve_points "curve_points"(const double *cubic, ptrdiff_t n, const ptrdiff_t *interval,
                                       const double *place, ptrdiff_t m, const double *end, double *points) nogil
    void c_curve_slopes "curve_slopes"(const double *cubic, ptrdiff_t n, const ptrdiff_t *interval,
                                       const double *place, ptrdiff_t m, double *derivatives) nogil
    void c_curve_speeds "curve_speeds"(const double *cubic, ptrdiff_t n, const double *places, ptrdiff_t m,
                                       double *lengths) nogil
    void c_cubic_values "cubic_values"(const double *knots, const double *values, const double *bends, ptrdiff_t n,
                                       ptrdiff_t width, const double *places, ptrdiff_t m, double *out) nogil
    void c_tridiagonal_solve "tridiagonal_solve"(const double *lower, const double *diagonal, const double *upper,
                                                 double *right, ptrdiff_t n, ptrdiff_t k, double *ratio) nogil

cdef extern from "geometry/lattice.h":
    void c_lattice_values "lattice_values"(const double *table, ptrdiff_t n, ptrdiff_t m, ptrdiff_t width,
                                           const double *u, const double *v, ptrdiff_t count, double *out) nogil

cdef extern from "geometry/segments.h":
    ptrdiff_t c_crossing_segments "crossing_segments"(
        const double *points, ptrdiff_t n, const ptrdiff_t *order, ptrdiff_t m, const double *low, const double *top,
        ptrdiff_t limit, long long *budget, ptrdiff_t *pairs) nogil


def count_folded(x, y, int threads=1):
    """Return the number of cells of the planes x, y (ni, nj) with a corner Jacobian that is not positive."""
    cdef Read px = reads(x, y.shape), py = reads(y, x.shape)
    cdef ptrdiff_t ni, nj, count
    ni, nj = x.shape
    with nogil:
        count = cells_folded(px, py, ni, nj, threads)
    return count


def folded_cells(x, y):
    """Return indices (n, 2) of the folded cells of the planes x, y (ni, nj), ascending."""
    cdef ptrdiff_t room = count_folded(x, y), ni, nj
    cdef Read px = reads(x, y.shape), py = reads(y, x.shape)
    ni, nj = x.shape
    pairs = np.empty((room, 2), dtype=np.int64)
    cdef int64_t *to = <int64_t *>numbers(pairs, b"i", 8, (room, 2), True)
    with nogil:
        cells_places(px, py, ni, nj, to, room)
    return pairs


def measure_cells(x, y, bint periodic, ptrdiff_t wake, summary, where, ptrdiff_t keep, kept, int threads=1):
    """Compute the metrics of all cells in one pass; for the arguments see CellRun in ``geometry/cells.h``."""
    cdef CellRun run
    cdef ptrdiff_t ni, nj
    cdef Read px = reads(x, y.shape), py = reads(y, x.shape)
    ni, nj = x.shape
    if ni < 2 or nj < 2 or not 0 <= keep <= METRICS - len(kept):
        raise ValueError("no cells, or metrics beyond the last")
    run.periodic, run.wake, run.keep, run.n_kept = periodic, wake, keep, len(kept)
    run.summary = fills(summary, (METRICS, 3))
    run.where = <int64_t *>numbers(where, b"i", 8, (METRICS, 2, 2), True)
    run.kept = fills(kept, (run.n_kept, ni - 1, nj - 1))
    threads = min(max(threads, 1), 64)
    scratch = np.empty(cells_scratch(ni, nj, threads))
    cdef Written room = fills(scratch, scratch.shape)
    with nogil:
        cells_run(px, py, ni, nj, &run, threads, room)


def curve_locate(s, table, start, stop, ptrdiff_t pieces, bint closed, interval, place):
    """Fill `interval` and the parameter in it, `place` from 0 to 1, for arc lengths `s`, (m,) each; ``geometry/curve.h``."""
    cdef ArcLengths curve
    cdef ptrdiff_t m = len(s), count = len(table) - 1
    curve.table, curve.start, curve.stop = reads(table, (count + 1,)), reads(start, (count,)), reads(stop, (count,))
    if pieces < 1 or count < pieces or count % pieces:
        raise ValueError("a table that does not fit its pieces")
    curve.n, curve.pieces, curve.closed = count // pieces, pieces, closed
    c_curve_locate(&curve, reads(s, (m,)), m, <ptrdiff_t *>numbers(interval, b"i", sizeof(ptrdiff_t), (m,), True),
                   fills(place, (m,)))


def curve_points(cubic, interval, place, end, points):
    """Fill `points` (m, 2) from cubics (4, n, 2) at parameters `place` (m,); the curve ends bitwise at `end` (2,)."""
    cdef ptrdiff_t n = cubic.shape[1], m = len(place)
    c_curve_points(reads(cubic, (4, n, 2)), n, reads_places(interval, (m,), n), reads(place, (m,)), m, reads(end, (2,)),
                   fills(points, (m, 2)))


def curve_slopes(cubic, interval, place, derivatives):
    """Fill `derivatives` (m, 2) with the derivatives by t of the cubics at parameters `place`."""
    cdef ptrdiff_t n = cubic.shape[1], m = len(place)
    c_curve_slopes(reads(cubic, (4, n, 2)), n, reads_places(interval, (m,), n), reads(place, (m,)), m,
                   fills(derivatives, (m, 2)))


def curve_speeds(cubic, places, lengths):
    """Fill `lengths` (n, m) with the norms of the derivatives at parameters `places` (m,) of each of n intervals."""
    cdef ptrdiff_t n = cubic.shape[1], m = len(places)
    c_curve_speeds(reads(cubic, (4, n, 2)), n, reads(places, (m,)), m, fills(lengths, (n, m)))


def cubic_values(knots, values, bends, places, out):
    """Fill `out` (m, width) at `places` (m,) from a spline's `values` and `bends` (n, width) at `knots` (n,)."""
    cdef ptrdiff_t n = len(knots), width = values.shape[1], m = len(places)
    if n < 2:
        raise ValueError("a spline of one knot")
    c_cubic_values(reads(knots, (n,)), reads(values, (n, width)), reads(bends, (n, width)), n, width,
                   reads(places, (m,)), m, fills(out, (m, width)))


def solve_tridiagonal(lower, diagonal, upper, right):
    """Solve a tridiagonal system of n rows, in place of `right` (n, k); the first `lower` and last `upper` are unused."""
    cdef ptrdiff_t n = len(diagonal), k = right.shape[1]
    ratio = np.empty(n)
    c_tridiagonal_solve(reads(lower, (n,)), reads(diagonal, (n,)), reads(upper, (n,)), fills(right, (n, k)), n, k,
                        fills(ratio, (n,)))


def crossing_segments(points, order, low, top, ptrdiff_t limit, long long budget):
    """Return pairs (k, 2), at most `limit`, of segments of a polygon that meet, and whether all were compared."""
    cdef ptrdiff_t n = len(points), m = len(order), count
    cdef Read p = reads(points, (n, 2))
    cdef const ptrdiff_t *sorted_by = reads_places(order, (m,), min(m, n))
    cdef Read first = reads(low, (m,)), last = reads(top, (m,))
    pairs = np.empty((limit, 2), np.intp)
    cdef ptrdiff_t *to = <ptrdiff_t *>numbers(pairs, b"i", sizeof(ptrdiff_t), (limit, 2), True)
    with nogil:
        count = c_crossing_segments(p, n, sorted_by, m, first, last, limit, &budget, to)
    return pairs[:count].tolist(), budget >= 0


cdef extern from "geometry/ahead.h":
    void c_nearest_ahead "nearest_ahead"(const double *walls, ptrdiff_t n, const double *points, const double *along,
                                         ptrdiff_t m, double cosine, double same, double *distances) nogil


def nearest_ahead(walls, points, along, double cosine, double same, distances):
    """Fill `distances` (m,) from `points` (m, 2) to the nearest of `walls` (n, 2) ahead of each; see ``ahead.h``."""
    cdef ptrdiff_t n = len(walls), m = len(points)
    cdef Read w = reads(walls, (n, 2)), p = reads(points, (m, 2)), t = reads(along, (m, 2))
    cdef Written to = fills(distances, (m,))
    with nogil:
        c_nearest_ahead(w, n, p, t, m, cosine, same, to)


cdef extern from "geometry/nearest.h":
    enum: nearest_block
    void c_nearest_points "nearest_points"(const double *places, ptrdiff_t m, const double *x, const double *y, ptrdiff_t n,
                                           const double *low, const double *high, ptrdiff_t *index, double *square) nogil


def nearest_points(places, points):
    """Return for each of `places` (m, 2) the index of the nearest of `points` (n >= 1, 2), and its squared distance."""
    cdef ptrdiff_t m = len(places), n = len(points)
    if n < 1:
        raise ValueError("no points")
    planes = np.ascontiguousarray(points.T)
    begins = np.arange(0, n, nearest_block)
    lows, highs = np.minimum.reduceat(points, begins), np.maximum.reduceat(points, begins)
    index, square = np.empty(m, dtype=np.intp), np.empty(m)
    cdef Read p = reads(places, (m, 2)), x = reads(planes[0], (n,)), y = reads(planes[1], (n,))
    cdef Read low = reads(lows, (len(begins), 2)), high = reads(highs, (len(begins), 2))
    cdef ptrdiff_t *at = <ptrdiff_t *>numbers(index, b"i", sizeof(ptrdiff_t), (m,), True)
    cdef Written out = fills(square, (m,))
    with nogil:
        c_nearest_points(p, m, x, y, n, low, high, at, out)
    return index, square


def lattice_values(table, u, v, out):
    """Fill `out` (p, k) with cubics through a `table` (n, m, k) at u, v (p,); see ``geometry/lattice.h``."""
    cdef ptrdiff_t n, m, width, count = len(u)
    n, m, width = table.shape
    cdef Read nodes = reads(table, (n, m, width)), along = reads(u, (count,)), across = reads(v, (count,))
    cdef Written to = fills(out, (count, width))
    if n < 4 or (m < 4 and m != 1):
        raise ValueError("a table of too few nodes")
    with nogil:
        c_lattice_values(nodes, n, m, width, along, across, count, to)
