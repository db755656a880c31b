#include <math.h>

#include "clones.h"
#include "functions.h"

static void swap_rows(double *values, ptrdiff_t width, ptrdiff_t a, ptrdiff_t b)
{
    for (ptrdiff_t j = 0; a != b && j < width; j++) {
        const double kept = values[a * width + j];
        values[a * width + j] = values[b * width + j], values[b * width + j] = kept;
    }
}

/* The row from k on whose entry in column k is largest, the first of several. */
static ptrdiff_t pivot_row(const double *matrix, ptrdiff_t n, ptrdiff_t k)
{
    ptrdiff_t row = k;
    for (ptrdiff_t i = k + 1; i < n; i++)
        if (fabs(matrix[i * n + k]) > fabs(matrix[row * n + k]))
            row = i;
    return row;
}

MESHONET_INLINE void subtract(double *restrict to, const double *restrict from, double share, ptrdiff_t count)
{
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < count; j++)
        to[j] -= share * from[j];
}

MESHONET_CLONES
int solve_system(double *matrix, ptrdiff_t n, double *right, ptrdiff_t columns)
{
    for (ptrdiff_t k = 0; k < n; k++) {
        const ptrdiff_t row = pivot_row(matrix, n, k);
        swap_rows(matrix, n, k, row), swap_rows(right, columns, k, row);
        const double pivot = matrix[k * n + k];
        if (pivot == 0.0)
            return 0;
        for (ptrdiff_t i = k + 1; i < n; i++) {
            const double share = matrix[i * n + k] / pivot;
            subtract(matrix + i * n + k + 1, matrix + k * n + k + 1, share, n - k - 1);
            subtract(right + i * columns, right + k * columns, share, columns);
        }
    }
    for (ptrdiff_t k = n - 1; k >= 0; k--) {
        for (ptrdiff_t j = 0; j < columns; j++)
            right[k * columns + j] /= matrix[k * n + k];
        for (ptrdiff_t i = 0; i < k; i++)
            subtract(right + i * columns, right + k * columns, matrix[i * n + k], columns);
    }
    return 1;
}
