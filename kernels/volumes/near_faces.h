#pragma once
#include <stddef.h>

/* A face of a volume: (n, m, 3) nodes across direction `axis`, at its low (0) or high (1) end. */
typedef struct {
    const double *nodes;
    ptrdiff_t n, m;
    int axis, end;
} Wall3;

/* Which inner node from first to last (excluded), numbered in order, is the first that has no place where the corners of
   all cells beside it on some walls, at most three, across different directions, are open; -1 if all have one. */
ptrdiff_t closed_node(const Wall3 *walls, int count, const ptrdiff_t *first, const ptrdiff_t *last, int threads);
