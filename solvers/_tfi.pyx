"""Compiled transfinite interpolation; the formula stands in ``tfi_kernel.c``."""

cdef extern from "tfi_kernel.h":
    ctypedef struct TfiEdges:
        const double *south
        const double *north
        const double *west
        const double *east
    void tfi_fill(double *x, double *y, Py_ssize_t ni, Py_ssize_t nj, const TfiEdges *ex, const TfiEdges *ey,
                  const TfiEdges *parameter) nogil


cdef TfiEdges edges(tuple four):
    """Return pointers into four arrays, which the caller keeps alive."""
    cdef const double[::1] south = four[0], north = four[1], west = four[2], east = four[3]
    cdef TfiEdges e
    e.south, e.north, e.west, e.east = &south[0], &north[0], &west[0], &east[0]
    return e


def fill(double[:, ::1] x, double[:, ::1] y, tuple xs, tuple ys, tuple parameters):
    """Interpolate into the planes `x` and `y` (ni, nj).

    `xs` and `ys` are the coordinates, `parameters` the values 0..1, of (south, north, west, east): (ni), (ni),
    (nj), (nj) contiguous float64 each.
    """
    for group in (xs, ys, parameters):
        for edge, n in zip(group, (x.shape[0], x.shape[0], x.shape[1], x.shape[1])):
            if len(edge) != n:
                raise ValueError(f"an edge has {len(edge)} nodes, the grid {n}")
    cdef TfiEdges ex = edges(xs), ey = edges(ys), parameter = edges(parameters)
    cdef Py_ssize_t ni = x.shape[0], nj = x.shape[1]
    with nogil:
        tfi_fill(&x[0, 0], &y[0, 0], ni, nj, &ex, &ey, &parameter)
