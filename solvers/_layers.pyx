"""Compiled layers at the ends of grid lines; see ``layers_kernel.c``."""

cdef extern from "layers_kernel.h":
    ctypedef struct Layers:
        double first
        double last
        Py_ssize_t constant
    double layer_steps(double *steps, Py_ssize_t cells, double length, const Layers *layers,
                       double *log_ratio) nogil
    double layer_lines(const double *x, const double *y, Py_ssize_t ni, Py_ssize_t nj, double *X, double *Y,
                       Py_ssize_t NJ, const Layers *layers, double *scratch) nogil


def fill_steps(double[::1] steps, double length, double first, double last, Py_ssize_t constant):
    """Fill `steps` (cells,) so that they add up to `length`; return the largest ratio of neighbours.

    The first `constant` ones are `first` long and the last `last`, where these are not 0; the others grow by one
    ratio from each end. Infinite: nothing fits.
    """
    cdef Layers layers
    cdef double log_ratio = 0.0
    check(steps.shape[0], first, last, constant)
    layers.first, layers.last, layers.constant = first, last, constant
    return layer_steps(&steps[0], steps.shape[0], length, &layers, &log_ratio)


def fill_lines(const double[:, ::1] x, const double[:, ::1] y, double[:, ::1] X, double[:, ::1] Y, double first,
               double last, Py_ssize_t constant, double[::1] scratch):
    """Sample the lines i of `x`, `y` (ni, nj >= 3) anew at the NJ nodes of `X`, `Y` (ni, NJ >= 3).

    The distance between the first two nodes is `first` and between the last two `last`, where these are not 0.
    `scratch` has 10 nj + NJ doubles. Returns the largest ratio of neighbouring cells.
    """
    cdef Layers layers
    cdef double largest
    cdef Py_ssize_t ni = x.shape[0], nj = x.shape[1], NJ = X.shape[1]
    if y.shape[0] != ni or y.shape[1] != nj or X.shape[0] != ni or Y.shape[0] != ni or Y.shape[1] != NJ \
            or nj < 3 or NJ < 3 or scratch.shape[0] < 10 * nj + NJ:
        raise ValueError("x, y, X, Y and scratch do not fit together")
    check(NJ - 1, first, last, constant)
    layers.first, layers.last, layers.constant = first, last, constant
    with nogil:
        largest = layer_lines(&x[0, 0], &y[0, 0], ni, nj, &X[0, 0], &Y[0, 0], NJ, &layers, &scratch[0])
    return largest


cdef int check(Py_ssize_t cells, double first, double last, Py_ssize_t constant) except -1:
    if not (first >= 0 and last >= 0 and first + last > 0 and constant >= 1):
        raise ValueError("no heights to make layers of")
    if cells < constant * ((first > 0) + (last > 0)) + 1:
        raise ValueError("fewer cells than constant layers")
    return 0
