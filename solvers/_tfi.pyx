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


def fill_all(double[:, :, :, ::1] nodes, tuple sides, tuple parameters):
    """Interpolate into the planes `nodes` (batch, 2, ni, nj).

    `sides` are (batch, 2, n) and `parameters` (batch, n) for south, north, west and east, contiguous float64.
    """
    cdef const double[:, :, ::1] south = sides[0], north = sides[1], west = sides[2], east = sides[3]
    cdef const double[:, ::1] s = parameters[0], n = parameters[1], w = parameters[2], e = parameters[3]
    cdef Py_ssize_t batch = nodes.shape[0], ni = nodes.shape[2], nj = nodes.shape[3], b
    cdef TfiEdges ex, ey, along
    for side, law, count in zip(sides, parameters, (ni, ni, nj, nj)):
        if side.shape != (batch, 2, count) or law.shape != (batch, count):
            raise ValueError(f"edges of shape {side.shape} for {batch} grids of {ni} x {nj}")
    if nodes.shape[1] != 2:
        raise ValueError("planes other than x and y")
    with nogil:
        for b in range(batch):
            ex.south, ex.north, ex.west, ex.east = &south[b, 0, 0], &north[b, 0, 0], &west[b, 0, 0], &east[b, 0, 0]
            ey.south, ey.north, ey.west, ey.east = &south[b, 1, 0], &north[b, 1, 0], &west[b, 1, 0], &east[b, 1, 0]
            along.south, along.north, along.west, along.east = &s[b, 0], &n[b, 0], &w[b, 0], &e[b, 0]
            tfi_fill(&nodes[b, 0, 0, 0], &nodes[b, 1, 0, 0], ni, nj, &ex, &ey, &along)
