/* A grid on few nodes evaluated on many; see evaluate.c. */
#pragma once
#include <stddef.h>

/* For each of some uniform places the knot before it and the weights (4) of the values there and at the next, and of
   the second derivatives at both: `places` of spline.py. */
typedef struct {
    const ptrdiff_t *first;
    const double *weights;
} Places;

/* Grids (m, n) and (ni, nj), and places of the second in the first. Shares of second derivatives are taken out up to
   `near` coarse cells from a corner, none from `far` on. What is missed of an edge is felt along `reach` of its steps. */
typedef struct {
    ptrdiff_t m, n, ni, nj;
    Places fine[2];
    double near, far, reach;
    int threads; /* that evaluate the fine grid, with the same result for any number */
} Evaluation;

/* Edges of one grid, planes (2, ni) and (2, nj); the share (4) taken out at its corners, those of west first, of each
   that of south first; and the coarse nodes (m, n) around which lines are straight, or NULL. */
typedef struct {
    const double *south, *north, *west, *east, *opened;
    const unsigned char *straight;
} Corners;

/* How many numbers evaluate_grid needs as scratch. */
ptrdiff_t evaluate_scratch(const Evaluation *e);

/* Fill the planes nodes (2, ni, nj) from the planes coarse (2, m, n). */
void evaluate_grid(const Evaluation *e, const double *coarse, const Corners *edges, double *scratch, double *nodes);

/* x (ni, nj) += w0 V[k] + w1 V[k+1] + w2 M[k] + w3 M[k+1] in rows 1 .. ni-2 (all rows with `rim`) and columns
   1 .. nj-2; k = first[i], w = weights[i] (ni, 4); V and M are (m, nj). */
void combine_rows(double *x, ptrdiff_t ni, ptrdiff_t nj, const ptrdiff_t *first, const double *weights,
                  const double *values, const double *bends, int rim, int threads);
