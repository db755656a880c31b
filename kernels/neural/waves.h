/* Waves along the rows and columns of fields: products with the tables of Waves, and folding, which halves them. */
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

/* Transform rows, folded: by the waves' `to`, and by their `back` in return. */
MESHONET_INLINE void along_rows(const Waves *w, const double *table, const double *in, ptrdiff_t rows, double *out)
{
    const ptrdiff_t less = w->count / 2, half = w->count - less, width = 2 * w->line;
    product(in, width, rows, half, table, w->line, w->line, out, width);
    product(in + w->line, width, rows, less, table + half * w->line, w->line, w->line, out + w->line, width);
}

/* Transform columns, folded or plain: by the waves' `back`, and by their `to` in return. */
MESHONET_INLINE void along_columns(const Waves *w, const double *table, const double *in, ptrdiff_t width, double *out)
{
    const ptrdiff_t less = w->folded ? w->count / 2 : 0, half = w->count - less;
    product(table, w->line, half, half, in, width, width, out, width);
    if (w->folded)
        product(table + half * w->line, w->line, less, less, in + half * width, width, width, out + half * width,
                width);
}

/* Columns to the sums and differences with their mirror images, and back, one field after another. */
MESHONET_INLINE void fold_columns(ptrdiff_t rows, ptrdiff_t width, const double *restrict in, double *restrict out)
{
    const ptrdiff_t less = rows / 2, half = rows - less;
    for (ptrdiff_t i = 0; i < half; i++)
        for (ptrdiff_t c = 0; c < width; c += LANES) {
            const Lanes one = OF(in + i * width + c), image = OF(in + (rows - 1 - i) * width + c);
            AT(out + i * width + c) = one + image;
            if (i < less)
                AT(out + (half + i) * width + c) = one - image;
        }
}

MESHONET_INLINE void unfold_columns(ptrdiff_t rows, ptrdiff_t width, const double *restrict in, double *restrict out)
{
    const ptrdiff_t less = rows / 2, half = rows - less;
    for (ptrdiff_t i = 0; i < half; i++)
        for (ptrdiff_t c = 0; c < width; c += LANES) {
            const Lanes sum = OF(in + i * width + c);
            const Lanes other = i < less ? OF(in + (half + i) * width + c) : sum;
            if (i < less)
                AT(out + (rows - 1 - i) * width + c) = sum - other;
            AT(out + i * width + c) = sum + other;
        }
}

#define MIRRORED(x) ((Lanes){(x)[7], (x)[6], (x)[5], (x)[4], (x)[3], (x)[2], (x)[1], (x)[0]})

/* A row to the sums and differences with its mirror image. */
MESHONET_INLINE void fold_row(const Waves *w, const double *row, double *out)
{
    for (ptrdiff_t j = 0; 2 * j < w->count; j += LANES) {
        const Lanes one = OF(row + j), behind = OF(row + w->count - LANES - j), image = MIRRORED(behind);
        AT(out + j) = one + image;
        AT(out + w->line + j) = one - image;
    }
}

/* Add to a row what sums and differences are of; beyond them are zeros. */
MESHONET_INLINE void unfold_row(const Waves *w, const double *in, double *row)
{
    for (ptrdiff_t j = 0; 2 * j < w->count; j += LANES) {
        const Lanes sum = OF(in + j), other = OF(in + w->line + j), image = sum - other;
        AT(row + j) += sum + other;
        AT(row + w->count - LANES - j) += MIRRORED(image);
    }
}
