/* Rows of a grid from rows of a spline; see combine.c. */
#ifndef MESHONET_COMBINE_H
#define MESHONET_COMBINE_H
#include <stddef.h>

/* x (ni, nj) += w0 V[k] + w1 V[k+1] + w2 M[k] + w3 M[k+1] in rows 1 .. ni-2 (all rows with `rim`) and columns
   1 .. nj-2; k = first[i], w = weights[i] (ni, 4); V and M are (m, nj). */
void combine_rows(double *x, ptrdiff_t ni, ptrdiff_t nj, const ptrdiff_t *first, const double *weights,
                  const double *values, const double *bends, int rim);
#endif
