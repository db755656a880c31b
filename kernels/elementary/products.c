#include <string.h>

#include "functions.h"
#include "sums.h"

#define ROWS 4    /* of a product at a time, for COLUMNS columns: their sums stay in registers */
#define QUADS 3 /* vectors of four doubles in a row of these sums */
#define COLUMNS (4 * QUADS)
#define DEPTH 256 /* terms of a sum at a time: the columns they need stay in the first cache */

typedef double Quad __attribute__((vector_size(4 * sizeof(double)), aligned(sizeof(double)), may_alias));

/* out (count rows, COLUMNS) += a (count, terms), rows `inner` apart, times b, rows of COLUMNS. */
MESHONET_INLINE void tile(const double *restrict a, ptrdiff_t inner, const double *restrict b, ptrdiff_t terms,
                          double *restrict out, ptrdiff_t columns, ptrdiff_t width, const int count)
{
    Quad sum[ROWS][QUADS];
    double rows[ROWS][COLUMNS] = {{0.0}};
#pragma GCC unroll 4
    for (int r = 0; r < count; r++)
        memcpy(rows[r], out + r * columns, (size_t)width * sizeof(double));
#pragma GCC unroll 4
    for (int r = 0; r < count; r++)
#pragma GCC unroll 3
        for (int q = 0; q < QUADS; q++)
            sum[r][q] = *(const Quad *)(rows[r] + 4 * q);
    for (ptrdiff_t k = 0; k < terms; k++) {
        const Quad *line = (const Quad *)(b + k * COLUMNS);
#pragma GCC unroll 4
        for (int r = 0; r < count; r++)
#pragma GCC unroll 3
            for (int q = 0; q < QUADS; q++)
                sum[r][q] += a[r * inner + k] * line[q];
    }
#pragma GCC unroll 4
    for (int r = 0; r < count; r++)
#pragma GCC unroll 3
        for (int q = 0; q < QUADS; q++)
            *(Quad *)(rows[r] + 4 * q) = sum[r][q];
#pragma GCC unroll 4
    for (int r = 0; r < count; r++)
        memcpy(out + r * columns, rows[r], (size_t)width * sizeof(double));
}

/* The part of a product that some columns and some terms of the sums make, of b packed. */
MESHONET_CLONES
static void panel(const double *a, ptrdiff_t rows, ptrdiff_t inner, const double *packed, ptrdiff_t terms, double *out,
                  ptrdiff_t columns, ptrdiff_t width)
{
    ptrdiff_t i = 0;
    for (; i + ROWS <= rows; i += ROWS)
        tile(a + i * inner, inner, packed, terms, out + i * columns, columns, width, ROWS);
    for (; i < rows; i++)
        tile(a + i * inner, inner, packed, terms, out + i * columns, columns, width, 1);
}

MESHONET_CLONES
static void with_vector(const double *a, const double *b, ptrdiff_t rows, ptrdiff_t inner, double *out)
{
    if (inner >= SUM_LANES) {
        for (ptrdiff_t i = 0; i < rows; i++)
            out[i] = product_of(a + i * inner, b, inner);
        return;
    }
    for (ptrdiff_t i = 0; i < rows; i++) {
        double sum = a[i * inner] * b[0];
        for (ptrdiff_t k = 1; k < inner; k++)
            sum += a[i * inner + k] * b[k];
        out[i] = sum;
    }
}

void matrix_product(const double *a, const double *b, ptrdiff_t rows, ptrdiff_t inner, ptrdiff_t columns, double *out)
{
    double packed[DEPTH * COLUMNS];
    if (columns == 1) {
        with_vector(a, b, rows, inner, out);
        return;
    }
    memset(out, 0, (size_t)(rows * columns) * sizeof *out);
    for (ptrdiff_t j = 0; j < columns; j += COLUMNS)
        for (ptrdiff_t start = 0; start < inner; start += DEPTH) {
            const ptrdiff_t width = columns - j < COLUMNS ? columns - j : COLUMNS;
            const ptrdiff_t terms = inner - start < DEPTH ? inner - start : DEPTH;
            for (ptrdiff_t k = 0; k < terms; k++) {
                memset(packed + k * COLUMNS, 0, COLUMNS * sizeof *packed);
                memcpy(packed + k * COLUMNS, b + (start + k) * columns + j, (size_t)width * sizeof *b);
            }
            panel(a + start, rows, inner, packed, terms, out + j, columns, width);
        }
}
