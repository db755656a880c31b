#pragma once
#include <stddef.h>

typedef struct {
    ptrdiff_t nodes, levels; /* levels: with the wall */
    double most;             /* the largest change of the logarithms of neighbouring cells */
    double used;             /* the same, a little less, that changed lines are given */
    double longest, first;   /* with changes `used` from the wall on, a line is first cell times longest / first long */
    double *lines;           /* (3, nodes, levels) */
} Growth;

/* Move nodes along those lines on which neighbouring cells differ by more. Returns 0, or -1 without memory. */
int limit_line_growth(const Growth *growth, int threads);
