/* Waves along the rows and columns of fields: products with the tables of Waves. */
#include "lanes.h"

#define BLOCK 8 /* rows of a product that are made together */

MESHONET_INLINE double summed(Lanes x)
{
    double sum = 0.0;
    for (int l = 0; l < LANES; l++)
        sum += x[l];
    return sum;
}

/* out (count, width) = a (count, inner) times b (inner, width), their rows so many numbers apart. */
MESHONET_INLINE void some_rows(const double *a, ptrdiff_t a_line, ptrdiff_t inner, const double *b, ptrdiff_t b_line,
                               ptrdiff_t width, double *out, ptrdiff_t out_line, const int count)
{
    for (ptrdiff_t c = 0; c < width; c += APPROACH_LINE) {
        Lanes low[BLOCK] = {{0}}, high[BLOCK] = {{0}};
        for (ptrdiff_t k = 0; k < inner; k++) {
            const Lanes one = OF(b + k * b_line + c), two = OF(b + k * b_line + c + LANES);
#pragma GCC unroll 8
            for (int r = 0; r < count; r++) {
                low[r] += a[r * a_line + k] * one;
                high[r] += a[r * a_line + k] * two;
            }
        }
#pragma GCC unroll 8
        for (int r = 0; r < count; r++) {
            AT(out + r * out_line + c) = low[r];
            AT(out + r * out_line + c + LANES) = high[r];
        }
    }
}

/* The same for any number of rows: some of the last come twice rather than alone. Not inlined: copies of it would be slow
   to compile and no faster. */
MESHONET_CLONES
static void product(const double *a, ptrdiff_t a_line, ptrdiff_t rows, ptrdiff_t inner, const double *b,
                             ptrdiff_t b_line, ptrdiff_t width, double *out, ptrdiff_t out_line)
{
    const ptrdiff_t together = rows < BLOCK ? 1 : BLOCK;
    for (ptrdiff_t i = 0; i < rows; i += together) {
        i = i + together > rows ? rows - together : i;
        if (together == BLOCK)
            some_rows(a + i * a_line, a_line, inner, b, b_line, width, out + i * out_line, out_line, BLOCK);
        else
            some_rows(a + i * a_line, a_line, inner, b, b_line, width, out + i * out_line, out_line, 1);
    }
}

/* Waves along rows (rows, width) of fields, and along their columns: out = in table, and out = table in. */
MESHONET_INLINE void along_rows(const Waves *w, const double *in, ptrdiff_t rows, double *out)
{
    product(in, w->line, rows, w->count, w->table, w->line, w->line, out, w->line);
}

MESHONET_INLINE void along_columns(const Waves *w, const double *in, ptrdiff_t width, double *out)
{
    product(w->table, w->line, w->count, w->count, in, width, width, out, width);
}
