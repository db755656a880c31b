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
} CellRun;

/* Doubles of scratch that a run over the cells of ni x nj nodes needs. */
size_t cells_scratch(ptrdiff_t ni, ptrdiff_t nj, int threads);

/* Run over all cells, with the same result for any number of threads. */
void cells_run(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const CellRun *run, int threads,
               double *scratch);
