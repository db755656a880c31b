"""Compiled transfinite grids on few nodes, and the evaluation of grids on few nodes at many; the formula stands in ``evaluate_kernel.c``."""

from libc.stdlib cimport free, malloc

cdef extern from "evaluate_kernel.h":
    ctypedef struct Places:
        const Py_ssize_t *first
        const double *weights
    ctypedef struct Evaluation:
        Py_ssize_t m
        Py_ssize_t n
        Py_ssize_t ni
        Py_ssize_t nj
        Places fine[2]
        Places thin[2]
        double near
        double far
        double reach
    ctypedef struct Corners:
        const double *south
        const double *north
        const double *west
        const double *east
        const double *opened
        const unsigned char *straight
    void evaluate_begin(const Evaluation *e, const Corners *edges, double *scratch, double *nodes) nogil
    Py_ssize_t evaluate_scratch(const Evaluation *e) nogil
    void evaluate_grid(const Evaluation *e, const double *coarse, const Corners *edges, double *scratch, double *nodes) nogil


cdef int place(Places *p, tuple found, Py_ssize_t count, Py_ssize_t knots) except -1:
    """Point into an answer of `spline.places`, which the caller keeps alive."""
    cdef const Py_ssize_t[::1] first = found[0]
    cdef const double[:, ::1] weights = found[1]
    cdef Py_ssize_t k
    if first.shape[0] != count or weights.shape[0] != count or weights.shape[1] != 4 or count < 2:
        raise ValueError("places for another number of nodes")
    for k in range(count):
        if first[k] < 0 or first[k] > knots - 2:
            raise ValueError("a place beyond the knots")
    p.first, p.weights = &first[0], &weights[0, 0]
    return 0


cdef int check(tuple sides, Py_ssize_t batch, Py_ssize_t ni, Py_ssize_t nj) except -1:
    """Refuse edges of another number of grids or nodes."""
    for side, count in zip(sides, (ni, ni, nj, nj)):
        if side.shape != (batch, 2, count):
            raise ValueError(f"edges of shape {side.shape} for {batch} grids of {ni} x {nj}")
    return 0


def begin_all(tuple sides, tuple thin, double[:, :, :, ::1] nodes):
    """Fill the planes `nodes` (batch, 2, m, n) by transfinite interpolation of edges, by their own arc lengths.

    `sides` are south, north (batch, 2, ni), west and east (batch, 2, nj), `thin` the `places` of m nodes in ni and of
    n in nj.
    """
    cdef const double[:, :, ::1] south = sides[0], north = sides[1], west = sides[2], east = sides[3]
    cdef Py_ssize_t batch = nodes.shape[0], b
    cdef Evaluation e
    cdef Corners edges
    e.m, e.n, e.ni, e.nj = nodes.shape[2], nodes.shape[3], south.shape[2], west.shape[2]
    if nodes.shape[1] != 2:
        raise ValueError("another number of grids")
    check(sides, batch, e.ni, e.nj)
    place(&e.thin[0], thin[0], e.m, e.ni)
    place(&e.thin[1], thin[1], e.n, e.nj)
    cdef double *scratch = <double *>malloc(6 * (e.m + e.n) * sizeof(double))
    if scratch == NULL:
        raise MemoryError
    with nogil:
        for b in range(batch):
            edges.south, edges.north = &south[b, 0, 0], &north[b, 0, 0]
            edges.west, edges.east = &west[b, 0, 0], &east[b, 0, 0]
            evaluate_begin(&e, &edges, scratch, &nodes[b, 0, 0, 0])
    free(scratch)


def evaluate_all(const double[:, :, :, ::1] coarse, tuple sides, tuple fine, const double[:, ::1] opened,
                 double near, double far, double reach, double[:, :, :, ::1] nodes,
                 const unsigned char[:, :, ::1] straight=None):
    """Fill the planes `nodes` (batch, 2, ni, nj) from grids `coarse` (batch, 2, m, n).

    `sides` are south, north (batch, 2, ni), west and east (batch, 2, nj); `fine` the `places` of ni nodes in m and of
    nj in n. `opened` (batch, 4) is the share that is taken out of second derivatives at corners, up to `near` coarse
    cells from them and none from `far` on; `straight` (batch, m, n) where all is. What is missed of an edge is felt
    along `reach` of its steps.
    """
    cdef const double[:, :, ::1] south = sides[0], north = sides[1], west = sides[2], east = sides[3]
    cdef Py_ssize_t batch = nodes.shape[0], b
    cdef Evaluation e
    cdef Corners edges
    e.m, e.n, e.ni, e.nj = coarse.shape[2], coarse.shape[3], nodes.shape[2], nodes.shape[3]
    e.near, e.far, e.reach = near, far, reach
    if coarse.shape[0] != batch or coarse.shape[1] != 2 or nodes.shape[1] != 2 or opened.shape[0] != batch or opened.shape[1] != 4:
        raise ValueError("another number of grids")
    if straight is not None and (straight.shape[0] != batch or straight.shape[1] != e.m or straight.shape[2] != e.n):
        raise ValueError("straight lines of another number of nodes")
    check(sides, batch, e.ni, e.nj)
    place(&e.fine[0], fine[0], e.ni, e.m)
    place(&e.fine[1], fine[1], e.nj, e.n)
    cdef double *scratch = <double *>malloc(evaluate_scratch(&e) * sizeof(double))
    if scratch == NULL:
        raise MemoryError
    with nogil:
        for b in range(batch):
            edges.south, edges.north = &south[b, 0, 0], &north[b, 0, 0]
            edges.west, edges.east, edges.opened = &west[b, 0, 0], &east[b, 0, 0], &opened[b, 0]
            edges.straight = NULL if straight is None else &straight[b, 0, 0]
            evaluate_grid(&e, &coarse[b, 0, 0, 0], &edges, scratch, &nodes[b, 0, 0, 0])
    free(scratch)
