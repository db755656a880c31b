/* A symmetric banded matrix, assembled from 2 x 2 blocks of nodes and solved by Cholesky's factors. */
#pragma once
#include "clones.h"
#include <math.h>
#include <stddef.h>

/* Symmetric matrix by rows: entry (k, m), k - band <= m <= k, at values[k (band + 1) + m - k + band]. */
typedef struct {
    double *values;
    ptrdiff_t count, band;
} Banded;

MESHONET_INLINE double *entry(const Banded *a, ptrdiff_t k, ptrdiff_t m)
{
    return a->values + k * (a->band + 1) + m - k + a->band;
}

/* Add the 2 x 2 block of nodes p (rows) and q (columns), given by their first unknowns, -1 for a fixed node; only
   the half below the diagonal is kept. */
MESHONET_INLINE void add_block(const Banded *a, ptrdiff_t p, ptrdiff_t q, double xx, double xy, double yx, double yy)
{
    if (p < 0 || q < 0)
        return;
    if (p < q) {
        const ptrdiff_t swap = p;
        p = q, q = swap;
        const double other = xy;
        xy = yx, yx = other;
    }
    double *row = entry(a, p, q), *next = row + a->band + 1; /* one row down, one column left of the same place */
    row[0] += xx;
    if (p != q)
        row[1] += xy;
    next[-1] += yx;
    next[0] += yy;
}

MESHONET_INLINE double dot(const double *restrict a, const double *restrict b, ptrdiff_t n)
{
    double sum = 0.0;
    for (ptrdiff_t k = 0; k < n; k++)
        sum += a[k] * b[k];
    return sum;
}

/* Products of two rows with two rows: half the loads of four products taken one by one. */
MESHONET_INLINE void four_dots(const double *restrict a0, const double *restrict a1, const double *restrict b0,
                               const double *restrict b1, ptrdiff_t n, double s[2][2])
{
    double s00 = 0.0, s01 = 0.0, s10 = 0.0, s11 = 0.0;
    for (ptrdiff_t k = 0; k < n; k++) {
        s00 += a0[k] * b0[k], s01 += a0[k] * b1[k];
        s10 += a1[k] * b0[k], s11 += a1[k] * b1[k];
    }
    s[0][0] = s00, s[0][1] = s01, s[1][0] = s10, s[1][1] = s11;
}

/* Inverse square root of what is left of a pivot; one that is not positive leaves its unknown alone. */
MESHONET_INLINE double inverse_root(double left, double pivot)
{
    return left > 1e-14 * pivot ? 1.0 / sqrt(left) : 1e-150;
}

/* Solve A d = b in place of b. A is overwritten by its Cholesky factor, with the inverse of its diagonal. Rows are
   taken in pairs, x and y of a node, which begin in the same column since the band is odd. */
MESHONET_CLONES
static void banded_solve(const Banded *a, double *b)
{
    const ptrdiff_t count = a->count, band = a->band;
    for (ptrdiff_t k = 0; k < count; k += 2) {
        const ptrdiff_t low = k + 1 > band ? k + 1 - band : 0;
        double *x = entry(a, k, low) - low, *y = entry(a, k + 1, low) - low, s[2][2]; /* indexed by column */
        for (ptrdiff_t m = low; m < k; m += 2) {
            const ptrdiff_t start = m + 1 - band > low ? m + 1 - band : low;
            const double *u = entry(a, m, start) - start, *v = entry(a, m + 1, start) - start;
            four_dots(x + start, y + start, u + start, v + start, m - start, s);
            x[m] = (x[m] - s[0][0]) * u[m];
            y[m] = (y[m] - s[1][0]) * u[m];
            x[m + 1] = (x[m + 1] - s[0][1] - x[m] * v[m]) * v[m + 1];
            y[m + 1] = (y[m + 1] - s[1][1] - y[m] * v[m]) * v[m + 1];
        }
        four_dots(x + low, y + low, x + low, y + low, k - low, s);
        x[k] = inverse_root(x[k] - s[0][0], x[k]);
        y[k] = (y[k] - s[1][0]) * x[k];
        y[k + 1] = inverse_root(y[k + 1] - s[1][1] - y[k] * y[k], y[k + 1]);
        b[k] = (b[k] - dot(x + low, b + low, k - low)) * x[k];
        b[k + 1] = (b[k + 1] - dot(y + low, b + low, k + 1 - low)) * y[k + 1];
    }
    for (ptrdiff_t k = count - 1; k >= 0; k--) {
        const ptrdiff_t low = k > band ? k - band : 0;
        const double *row = entry(a, k, low) - low, value = b[k] *= row[k];
        for (ptrdiff_t m = low; m < k; m++)
            b[m] -= value * row[m];
    }
}
