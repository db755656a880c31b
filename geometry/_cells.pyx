"""Compiled half of `meshonet.geometry.quality.measure`: one pass over the cells of a grid.

``x`` and ``y`` are the (ni, nj) C-contiguous planes of a grid's nodes.
"""

from libc.stdint cimport int64_t

import numpy as np


cdef extern from "cells_kernel.h":
    int METRICS
    ptrdiff_t cells_folded_in_row(const double *x, const double *y, ptrdiff_t nj, ptrdiff_t cells) nogil
    ptrdiff_t cells_list_folded(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, int64_t *pairs, ptrdiff_t room) nogil
    void cells_areas(const double *x, const double *y, ptrdiff_t nj, double *area) nogil
    void cells_row(const double *x, const double *y, ptrdiff_t nj, const double *before, const double *here, const double *after, double *out) nogil
    void cells_reduce(const double *row, ptrdiff_t cells, double *low, double *high, double *sum) nogil
    ptrdiff_t cells_catch(const double *row, ptrdiff_t cells, double low, double high, int64_t *counts, double *caught, ptrdiff_t room) nogil


def count_folded(const double[:, ::1] x, const double[:, ::1] y):
    """Return how many cells have a corner Jacobian that is not positive."""
    cdef ptrdiff_t ni = x.shape[0], nj = x.shape[1], i, folded = 0
    with nogil:
        for i in range(ni - 1):
            folded += cells_folded_in_row(&x[i, 0], &y[i, 0], nj, nj - 1)
    return folded


def folded_cells(const double[:, ::1] x, const double[:, ::1] y, ptrdiff_t room):
    """Return (n, 2) indices of folded cells in order of (i, j), `room` at the most."""
    cdef int64_t[:, ::1] pairs = np.empty((max(room, 1), 2), dtype=np.int64)
    cdef ptrdiff_t found
    with nogil:
        found = cells_list_folded(&x[0, 0], &y[0, 0], x.shape[0], x.shape[1], &pairs[0, 0], room)
    return np.asarray(pairs)[:min(found, room)]


def measure(const double[:, ::1] x, const double[:, ::1] y, bint periodic, ptrdiff_t wake, double[:, ::1] summary,
            int64_t[:, :, ::1] where, int keep, double[:, :, ::1] kept,
            const double[:, :, ::1] brackets, int64_t[:, :, ::1] counts, double[:, :, ::1] caught):
    """Run over all cells once.

    periodic: the last column of nodes is the first. wake: cells (i, 0) and (ni-2-i, 0) with i < wake are
    neighbours. summary (METRICS, 3): min, mean, max of each metric. where (METRICS, 2, 2): cell (i, j) of the min and of
    the max, first in order. keep: the first of the metrics whose values go to `kept` (n, ni-1, nj-1).
    brackets (METRICS, m, 2): pairs of values; counts (METRICS, m, 4), zeros before: how many cells are less than
    the first, at most the first, less than the second, at most the second. caught (METRICS, m, room): values
    between the two, in no order; there are more than `room` when the counts say so.
    """
    cdef ptrdiff_t ni = x.shape[0], nj = x.shape[1], cells = nj - 1, i, j, k, m, had, room = caught.shape[2]
    cdef double[:, ::1] areas = np.empty((4, nj + 1))
    cdef double[:, ::1] rows = np.empty((METRICS, cells))
    cdef double low, high, total
    cdef double *before
    cdef double *here
    cdef double *after
    with nogil:
        # areas of the rows of cells i-1, i, i+1 take turns in buffers 0 to 2; buffer 3 is the row across the seam
        cells_areas(&x[0, 0], &y[0, 0], nj, &areas[0, 0])
        cells_areas(&x[ni - 2, 0], &y[ni - 2, 0], nj, &areas[3, 0])
        before = &areas[3, 0] if periodic else &areas[0, 0]
        for i in range(ni - 1):
            here = &areas[i % 3, 0]
            if i < ni - 2:
                after = &areas[(i + 1) % 3, 0]
                cells_areas(&x[i + 1, 0], &y[i + 1, 0], nj, after)
            elif periodic:
                cells_areas(&x[0, 0], &y[0, 0], nj, &areas[3, 0])
                after = &areas[3, 0]
            else:
                after = here
            if i < wake or i >= ni - 1 - wake:
                m = ni - 2 - i  # the cell on the other side of the wake
                here[0] = 0.5 * abs((x[m + 1, 1] - x[m, 0]) * (y[m, 1] - y[m + 1, 0])
                                    - (y[m + 1, 1] - y[m, 0]) * (x[m, 1] - x[m + 1, 0]))
            cells_row(&x[i, 0], &y[i, 0], nj, before, here, after, &rows[0, 0])
            before = here
            for k in range(METRICS):
                cells_reduce(&rows[k, 0], cells, &low, &high, &total)
                if i == 0 or low < summary[k, 0]:
                    summary[k, 0] = low
                    note(&rows[k, 0], cells, low, i, &where[k, 0, 0])
                if i == 0 or high > summary[k, 2]:
                    summary[k, 2] = high
                    note(&rows[k, 0], cells, high, i, &where[k, 1, 0])
                summary[k, 1] = total if i == 0 else summary[k, 1] + total
                for m in range(brackets.shape[1]):
                    had = min(counts[k, m, 2] - counts[k, m, 1], room)
                    cells_catch(&rows[k, 0], cells, brackets[k, m, 0], brackets[k, m, 1], &counts[k, m, 0],
                                &caught[k, m, 0] + had, room - had)
            for k in range(kept.shape[0]):
                for j in range(cells):
                    kept[k, i, j] = rows[keep + k, j]
        for k in range(METRICS):
            summary[k, 1] /= (ni - 1) * cells


cdef inline void note(const double *row, ptrdiff_t cells, double value, ptrdiff_t i, int64_t *where) noexcept nogil:
    """Store where in a row `value` stands first."""
    cdef ptrdiff_t j = 0
    while j < cells - 1 and row[j] != value:
        j += 1
    where[0] = i
    where[1] = j
