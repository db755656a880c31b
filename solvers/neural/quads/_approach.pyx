"""Compiled Picard steps towards Winslow's grids: the arithmetic of ``approach.py``, which is its reference."""

from libc.stdlib cimport free, malloc

cdef extern from "approach_kernel.h":
    enum: APPROACH_WIDTH
    ctypedef struct Approach:
        Py_ssize_t m
        Py_ssize_t n
        Py_ssize_t rows
        Py_ssize_t width
        int around
        int harmonic
        int steps
        double share
        double growth
        const double *left
        const double *right
        const double *slow
        const double *fast
    Py_ssize_t approach_scratch(const Approach *a) nogil
    void approach_grid(const Approach *a, double *p, const double *turn, double *scratch, double *step) nogil

WIDTH = APPROACH_WIDTH


def approach_all(double[:, :, :, ::1] planes, const double[:, :, ::1] turns, bint harmonic, int steps, double share, double growth,
                 const double[:, ::1] left, const double[::1] slow, const double[:, ::1] right, const double[::1] fast,
                 bint around, double[:, :, :, ::1] last):
    """Move the `planes` (batch, 2, m, n) in place, and fill `last` with each one's last step.

    `left` (rows, rows), `slow` (rows), `right` (width, width) and `fast` (width) are tables of `approach.tables`;
    `turns` (batch, 2, n) what is added from one round to the next. The steps go out from Laplace's solution when `harmonic`.
    """
    cdef Py_ssize_t batch = planes.shape[0], b
    cdef Approach a
    a.m, a.n, a.around, a.harmonic, a.steps = planes.shape[2], planes.shape[3], around, harmonic, steps
    a.share, a.growth = share, growth
    a.rows, a.width = a.m - (1 if around else 2), right.shape[0]
    if planes.shape[1] != 2 or a.m < 6 or a.n < 6 or a.width < a.n - 2 or a.width % APPROACH_WIDTH:
        raise ValueError("planes or tables of a wrong shape")
    if left.shape[0] != a.rows or left.shape[1] != a.rows or slow.shape[0] != a.rows:
        raise ValueError("tables for another number of rows")
    if right.shape[1] != a.width or fast.shape[0] != a.width:
        raise ValueError("tables for another number of columns")
    if last.shape[0] != batch or last.shape[1] != 2 or last.shape[2] != a.m or last.shape[3] != a.n:
        raise ValueError("last steps of another shape")
    if turns.shape[0] != batch or turns.shape[1] != 2 or turns.shape[2] != a.n:
        raise ValueError("turns of another shape")
    a.left, a.slow, a.right, a.fast = &left[0, 0], &slow[0], &right[0, 0], &fast[0]
    cdef double *scratch = <double *>malloc(approach_scratch(&a) * sizeof(double))
    if scratch == NULL:
        raise MemoryError
    with nogil:
        for b in range(batch):
            approach_grid(&a, &planes[b, 0, 0, 0], &turns[b, 0, 0], scratch, &last[b, 0, 0, 0])
    free(scratch)
