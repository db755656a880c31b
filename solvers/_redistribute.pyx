"""Compiled redistribution of nodes along grid lines; see ``redistribute_kernel.c``."""

cdef extern from "redistribute_kernel.h":
    void redistribute_lines(double *x, double *y, Py_ssize_t ni, Py_ssize_t nj, const double *first, const double *fade,
                            double *scratch) nogil


def redistribute(double[:, ::1] x, double[:, ::1] y, const double[::1] first, const double[::1] fade,
                 double[::1] scratch):
    """Move the inner nodes of the lines i of `x` and `y` (ni, nj >= 3) so that first cells are `first` (ni) high.

    `fade` (nj) says how much of the relative change of node 1 each node takes part in; `scratch` has 5 nj.
    """
    cdef Py_ssize_t ni = x.shape[0], nj = x.shape[1]
    if y.shape[0] != ni or y.shape[1] != nj or first.shape[0] != ni or fade.shape[0] != nj or scratch.shape[0] < 5 * nj or nj < 3:
        raise ValueError("x, y, first, fade and scratch do not fit together")
    with nogil:
        redistribute_lines(&x[0, 0], &y[0, 0], ni, nj, &first[0], &fade[0], &scratch[0])
