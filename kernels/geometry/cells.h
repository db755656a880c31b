/* Measures of the cells of a structured grid, whose nodes are the planes x and y (ni, nj). */
#pragma once
#include <stddef.h>
#include <stdint.h>

enum { MAX_ANGLE, MIN_ANGLE, SKEWNESS, SCALED_JACOBIAN, ASPECT_RATIO, ORTHOGONALITY, AREA_RATIO, METRICS };

/* How many cells have a corner Jacobian that is not positive. */
ptrdiff_t cells_folded(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, int threads);

/* The indices (i, j) of the first `room` of them. */
void cells_places(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, int64_t *pairs, ptrdiff_t room);

/* What one run over all cells takes and leaves. */
typedef struct {
    int periodic;      /* the last row of nodes is the first */
    ptrdiff_t wake;    /* cells (i, 0) and (ni - 2 - i, 0) with i < wake are neighbours */
    double *summary;   /* (METRICS, 3): min, mean, max */
    int64_t *where;    /* (METRICS, 2, 2): cell (i, j) of the min and of the max, first in order */
    ptrdiff_t keep, n_kept; /* the first of the metrics whose values are kept, and how many are */
    double *kept;      /* (n_kept, ni - 1, nj - 1) */
    ptrdiff_t n_brackets, room;
    const double *brackets; /* (METRICS, n_brackets, 2): pairs of values */
    int64_t *counts;   /* (METRICS, n_brackets, 4), zeros before: how many are less than the first, at most the first,
                          less than the second, at most the second */
    double *caught;    /* (METRICS, n_brackets, room): values between the two, in no order; there are more than `room`
                          when the counts say so */
} CellRun;

/* Doubles of scratch that a run over the cells of ni x nj nodes needs. */
size_t cells_scratch(const CellRun *run, ptrdiff_t ni, ptrdiff_t nj, int threads);

/* Run over all cells, with the same result for any number of threads; only the order of what is caught differs. */
void cells_run(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const CellRun *run, int threads,
               double *scratch);
