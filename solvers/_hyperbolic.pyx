"""Compiled hyperbolic marching; the equations stand in ``hyperbolic_kernel.c``."""

cdef extern from "hyperbolic_kernel.h":
    ctypedef struct MarchSettings:
        double dissipation
        double even
        double tolerated
        double bend
        double implicit
        double volume
        Py_ssize_t sweeps
        Py_ssize_t rise
    ctypedef struct MarchEnds:
        double first_x
        double first_y
        double last_x
        double last_y
    size_t hyperbolic_scratch(Py_ssize_t n) nogil
    void hyperbolic_march(double *x, double *y, Py_ssize_t n, Py_ssize_t levels, const double *steps,
                          const double *widening, const MarchEnds *ends, const MarchSettings *settings, double *scratch) nogil


def scratch_size(Py_ssize_t n):
    """Return the doubles of scratch that a march over n nodes a level needs."""
    return hyperbolic_scratch(n)


def march(double[:, ::1] x, double[:, ::1] y, const double[::1] steps, double dissipation, double even, double tolerated,
          double bend, double implicit, double volume, Py_ssize_t sweeps, Py_ssize_t rise, double[::1] scratch, ends=None, widening=None):
    """Fill levels 1 on of `x` and `y` (levels + 1, n) from level 0, n >= 3 nodes with the grid to their left.

    `steps` (levels) are the distances between levels; the others are those of ``hyperbolic_kernel.h``. Level 0
    closes, unless `ends` are two unit directions (2, 2) along which its ends move; then `widening` (n) multiplies
    the steps next to it.
    """
    cdef Py_ssize_t n = x.shape[1], levels = x.shape[0] - 1
    cdef MarchSettings settings = MarchSettings(dissipation, even, tolerated, bend, implicit, volume, sweeps, rise)
    cdef MarchEnds directions
    cdef MarchEnds *given = NULL
    cdef const double[::1] wide = steps
    if y.shape[0] != x.shape[0] or y.shape[1] != n or steps.shape[0] != levels or n < 3 or levels < 1:
        raise ValueError("x, y and steps do not fit together")
    if <size_t>scratch.shape[0] < hyperbolic_scratch(n):
        raise ValueError("too little scratch")
    if ends is not None:
        wide = widening
        if wide.shape[0] != n:
            raise ValueError("widening does not fit")
        directions = MarchEnds(ends[0][0], ends[0][1], ends[1][0], ends[1][1])
        given = &directions
    with nogil:
        hyperbolic_march(&x[0, 0], &y[0, 0], n, levels, &steps[0], &wide[0], given, &settings, &scratch[0])
