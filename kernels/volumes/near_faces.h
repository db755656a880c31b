#pragma once
#include <stddef.h>

/* A face of a volume: (n, m, 3) nodes across direction `axis`, at its low (0) or high (1) end. */
typedef struct {
    const double *nodes;
    ptrdiff_t n, m;
    int axis, end;
} Wall3;

/* The number of the first inner node, from first to last (excluded), for which no position gives all corners of cells at
   the walls beside it, at most three across different directions, positive Jacobians; -1 if there is none. */
ptrdiff_t closed_node(const Wall3 *walls, int count, const ptrdiff_t *first, const ptrdiff_t *last, int threads);
