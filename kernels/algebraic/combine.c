/* The last step of a separable cubic spline: every row of the fine grid is a combination of two rows of values
   and two of second derivatives, so that one pass over the grid adds it. */
#include "combine.h"
#include "clones.h"

MESHONET_CLONES
void combine_rows(double *x, ptrdiff_t ni, ptrdiff_t nj, const ptrdiff_t *first, const double *weights,
                  const double *values, const double *bends, int rim)
{
    for (ptrdiff_t i = rim ? 0 : 1; i < (rim ? ni : ni - 1); i++) {
        const double w0 = weights[4 * i], w1 = weights[4 * i + 1], w2 = weights[4 * i + 2], w3 = weights[4 * i + 3];
        const double *restrict v0 = values + first[i] * nj, *restrict v1 = v0 + nj;
        const double *restrict m0 = bends + first[i] * nj, *restrict m1 = m0 + nj;
        double *restrict row = x + i * nj;
        for (ptrdiff_t j = 1; j < nj - 1; j++)
            row[j] += (w0 * v0[j] + w1 * v1[j]) + (w2 * m0[j] + w3 * m1[j]);
    }
}
