"""Compiled last step of a separable spline; the formula stands in ``combine_kernel.c``."""

cdef extern from "combine_kernel.h":
    void combine_rows(double *x, Py_ssize_t ni, Py_ssize_t nj, const Py_ssize_t *first, const double *weights,
                      const double *values, const double *bends, int rim) nogil


def add_rows(double[:, ::1] x, const Py_ssize_t[::1] first, const double[:, ::1] weights,
             const double[:, ::1] values, const double[:, ::1] bends, bint rim):
    """Add to row i of `x` (ni, nj) the rows first[i] and first[i]+1 of `values` and `bends` (m, nj).

    `weights` (ni, 4) go to the two rows of values and the two of bends. The first and last column stay as
    they are, and without `rim` the first and last row.
    """
    cdef Py_ssize_t ni = x.shape[0], nj = x.shape[1], m = values.shape[0], i
    if first.shape[0] != ni or weights.shape[0] != ni or weights.shape[1] != 4:
        raise ValueError("weights for other rows")
    if values.shape[1] != nj or bends.shape[1] != nj or bends.shape[0] != m:
        raise ValueError("a spline of other columns")
    for i in range(ni):
        if first[i] < 0 or first[i] > m - 2:
            raise ValueError("a row beyond the spline")
    with nogil:
        combine_rows(&x[0, 0], ni, nj, &first[0], &weights[0, 0], &values[0, 0], &bends[0, 0], rim)
