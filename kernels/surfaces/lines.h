#pragma once
#include <stddef.h>

typedef struct {
    ptrdiff_t nodes, levels;   /* levels: with the wall */
    const double *marched;     /* (levels, 3, nodes) */
    const double *steps;       /* (levels - 1): the law, from the first cell on */
    const double *fade;        /* (levels - 1): 1 at the wall, then less: how far the first cell rules */
    const ptrdiff_t *order;    /* (nodes): where the line of each node stands in the result */
    ptrdiff_t sweeps;          /* smoothing sweeps of the ratio of steps to the law */
    double *lines;             /* (3, nodes, levels): the result */
} Lines;

/* Move nodes along their lines so that first cells are exact and steps follow the law more closely. Returns 0, or -1
   without memory. */
int respace_lines(const Lines *lines, int threads);
