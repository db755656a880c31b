#pragma once
#include <stddef.h>

/* n places in the plane or in space with an affine motion each, d(x) = a + B x. A place at distance r weighs
   area (1/r^2 + near2/r^4) in the plane, a line of them, and area (1/r^3 + near2/r^5) in space. */
typedef struct {
    ptrdiff_t n;
    int axes;             /* 2 or 3 */
    const double *place;  /* (axes, n) */
    const double *area;   /* (n) */
    const double *motion; /* (axes + axes*axes, n): a, then B row by row */
    double near2;         /* square of the distance inside which the nearest places prevail */
} BlendSources;

/* Means of the motions at m points x (axes, m), weighted by nearness. */
void blend_motions(const BlendSources *from, const double *x, ptrdiff_t m, int threads, double *moved);

/* The transposed map in the plane: `gathered` (6, n) gets what `pull` (2, m) does to a and B of every place. `weight`
   has room for n numbers. */
void blend_transposed(const BlendSources *from, const double *x, const double *pull, ptrdiff_t m, double *weight,
                      double *gathered);
