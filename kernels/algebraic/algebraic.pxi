cdef extern from "algebraic/tfi.h":
    ctypedef struct TfiEdges:
        Read south, north, west, east
    void tfi_fill(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const TfiEdges *ex, const TfiEdges *ey,
                  const TfiEdges *parameter, int threads) nogil

cdef extern from "algebraic/evaluate.h":
    ctypedef struct Places:
        const ptrdiff_t *first
        const double *weights
    ctypedef struct Evaluation:
        ptrdiff_t m, n, ni, nj
        Places fine[2]
        double near, far, reach
        int threads
    ctypedef struct Corners:
        Read south, north, west, east, opened
        const unsigned char *straight
    ptrdiff_t evaluate_scratch(const Evaluation *e) nogil
    void evaluate_grid(const Evaluation *e, const double *coarse, const Corners *edges, double *scratch,
                       double *nodes) nogil
    void combine_rows(double *x, ptrdiff_t ni, ptrdiff_t nj, const ptrdiff_t *first, const double *weights,
                      const double *values, const double *bends, int rim, int threads) nogil


cdef TfiEdges four_edges(tuple four, tuple along, tuple across) except *:
    """Return pointers into arrays for south, north, west and east."""
    cdef TfiEdges e
    e.south, e.north = reads(four[0], along), reads(four[1], along)
    e.west, e.east = reads(four[2], across), reads(four[3], across)
    return e


def tfi(x, y, tuple xs, tuple ys, tuple parameters, int threads=1):
    """Fill the planes `x` and `y` (ni, nj) by transfinite interpolation between edges south, north, west and east.

    `parameters` are the interpolation parameters along the edges. The results of all kernels with `threads` are bitwise
    the same for any number of threads.
    """
    cdef Written px = fills(x, y.shape), py = fills(y, x.shape)
    cdef ptrdiff_t ni, nj
    ni, nj = x.shape
    cdef TfiEdges ex = four_edges(xs, (ni,), (nj,)), ey = four_edges(ys, (ni,), (nj,))
    cdef TfiEdges parameter = four_edges(parameters, (ni,), (nj,))
    with nogil:
        tfi_fill(px, py, ni, nj, &ex, &ey, &parameter, threads)


def add_spline_rows(x, first, weights, values, bends, bint rim, int threads=1):
    """Add to `x` (ni, nj) rows of a spline with `values` and second derivatives `bends` (m, nj); ``algebraic/evaluate.h``."""
    cdef ptrdiff_t ni, nj, m = len(values)
    ni, nj = x.shape
    cdef Places p = places((first, weights), ni, m)
    cdef Written px = fills(x, (ni, nj))
    cdef Read v = reads(values, (m, nj)), c = reads(bends, (m, nj))
    with nogil:
        combine_rows(px, ni, nj, p.first, p.weights, v, c, rim, threads)


cdef Places places(tuple given, ptrdiff_t count, ptrdiff_t knots) except *:
    """Return pointers into an answer of `spline.places`."""
    cdef Places p
    p.first, p.weights = reads_places(given[0], (count,), knots - 1), reads(given[1], (count, 4))
    return p


cdef Corners corners_of(tuple sides, ptrdiff_t batch, ptrdiff_t ni, ptrdiff_t nj) except *:
    cdef Corners c
    c.south, c.north = reads(sides[0], (batch, 2, ni)), reads(sides[1], (batch, 2, ni))
    c.west, c.east = reads(sides[2], (batch, 2, nj)), reads(sides[3], (batch, 2, nj))
    c.opened, c.straight = NULL, NULL
    return c


cdef void next_grid(const Evaluation *e, Corners *c) noexcept nogil:
    """Go on to the edges of the next grid of a batch."""
    c.south, c.north, c.west, c.east = c.south + 2 * e.ni, c.north + 2 * e.ni, c.west + 2 * e.nj, c.east + 2 * e.nj


def resample(coarse, tuple sides, tuple fine, opened, double near, double far, double reach, nodes, straight=None,
             int threads=1):
    """Fill the planes `nodes` (batch, 2, ni, nj) by evaluating coarse grids (batch, 2, m, n) between edges `sides`.

    `fine` holds the positions of the ni nodes in m and of the nj nodes in n; for the others see
    ``algebraic/evaluate.h``.
    """
    cdef ptrdiff_t batch = len(nodes), b
    cdef Evaluation e
    e.m, e.n, e.ni, e.nj = coarse.shape[2], coarse.shape[3], nodes.shape[2], nodes.shape[3]
    e.near, e.far, e.reach, e.threads = near, far, reach, min(max(threads, 1), 64)
    cdef Corners edges = corners_of(sides, batch, e.ni, e.nj)
    edges.opened = reads(opened, (batch, 4))
    if straight is not None:
        edges.straight = <const unsigned char *>numbers(straight, b"B", 1, (batch, e.m, e.n), False)
    e.fine[0], e.fine[1] = places(fine[0], e.ni, e.m), places(fine[1], e.nj, e.n)
    cdef Read given = reads(coarse, (batch, 2, e.m, e.n))
    cdef Written to = fills(nodes, (batch, 2, e.ni, e.nj))
    scratch = np.empty(evaluate_scratch(&e))
    cdef Written room = fills(scratch, scratch.shape)
    with nogil:
        for b in range(batch):
            evaluate_grid(&e, given, &edges, room, to)
            next_grid(&e, &edges)
            edges.opened += 4
            if edges.straight != NULL:
                edges.straight += e.m * e.n
            given += 2 * e.m * e.n
            to += 2 * e.ni * e.nj
