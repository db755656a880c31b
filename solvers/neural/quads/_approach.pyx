"""Compiled Picard steps towards Winslow's grids: the arithmetic of ``approach.py``, which is its reference."""

from libc.stdint cimport uintptr_t
from libc.stdlib cimport calloc, free

cdef extern from "approach_kernel.h":
    enum: APPROACH_LINE
    ctypedef struct Waves:
        int folded
        Py_ssize_t count
        Py_ssize_t line
        const double *to
        const double *back
        const double *values
    ctypedef struct Approach:
        Py_ssize_t m
        Py_ssize_t n
        int around
        int harmonic
        int steps
        double share
        double growth
        Waves xi
        Waves eta
    Py_ssize_t approach_scratch(const Approach *a) nogil
    void approach_grid(const Approach *a, double *p, const double *turn, double *scratch, double *step) nogil

LINE = APPROACH_LINE


cdef int tables(Waves *w, tuple found, Py_ssize_t count, bint folded) except -1:
    """Point into tables of `approach`, which the caller keeps alive."""
    cdef const double[:, ::1] to = found[0], back = found[1], values = found[2]
    cdef Py_ssize_t line = to.shape[1]
    if to.shape[0] != count or back.shape[0] != count or back.shape[1] != line or values.shape[1] != line:
        raise ValueError("tables for another number of nodes")
    if values.shape[0] != 1 + folded or line < (count - count // 2 if folded else count) or (folded and line % APPROACH_LINE):
        raise ValueError("tables of a wrong shape")
    w.folded, w.count, w.line = folded, count, line
    w.to, w.back, w.values = &to[0, 0], &back[0, 0], &values[0, 0]
    return 0


def approach_all(double[:, :, :, ::1] planes, const double[:, :, ::1] turns, bint harmonic, int steps, double share, double growth,
                 tuple xi, tuple eta, bint around, double[:, :, :, ::1] last):
    """Move the `planes` (batch, 2, m, n) in place, and fill `last` with each one's last step.

    `xi` and `eta` are tables of `approach`; `turns` (batch, 2, n) what is added from one round to the next. The steps
    go out from Laplace's solution when `harmonic`.
    """
    cdef Py_ssize_t batch = planes.shape[0], b
    cdef Approach a
    a.m, a.n, a.around, a.harmonic, a.steps = planes.shape[2], planes.shape[3], around, harmonic, steps
    a.share, a.growth = share, growth
    if planes.shape[1] != 2 or a.m < 6 or a.n < 6:
        raise ValueError("planes of a wrong shape")
    tables(&a.xi, xi, a.m - (1 if around else 2), not around)
    tables(&a.eta, eta, a.n - 2, True)
    if last.shape[0] != batch or last.shape[1] != 2 or last.shape[2] != a.m or last.shape[3] != a.n:
        raise ValueError("last steps of another shape")
    if turns.shape[0] != batch or turns.shape[1] != 2 or turns.shape[2] != a.n:
        raise ValueError("turns of another shape")
    cdef double *room = <double *>calloc(approach_scratch(&a) + 8, sizeof(double))
    if room == NULL:
        raise MemoryError
    cdef double *scratch = room + (-(<uintptr_t>room // sizeof(double)) & 7)  # from a line of the cache on
    with nogil:
        for b in range(batch):
            approach_grid(&a, &planes[b, 0, 0, 0], &turns[b, 0, 0], scratch, &last[b, 0, 0, 0])
    free(room)
