#pragma once
#include <stddef.h>

/* One coordinate of the four edges. */
typedef struct {
    const double *south, *north; /* (ni) */
    const double *west, *east;   /* (nj) */
} TfiEdges;

/* Fill the planes x and y (ni, nj), with the same result for any number of threads; see tfi.c. */
void tfi_fill(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const TfiEdges *ex, const TfiEdges *ey,
              const TfiEdges *parameter, int threads);
