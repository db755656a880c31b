#include "columns.h"

#include "fft.h"

#define BLOCK 128 /* rows that stay in the first-level cache while they are combined with each other */

/* Transforms of `size` rows from those of their halves. */
MESHONET_INLINE void combine(double *rows, ptrdiff_t size, const double *unit, ptrdiff_t step, ptrdiff_t width)
{
    const ptrdiff_t half = size / 2, apart = 2 * width;
    for (ptrdiff_t j = 0; j < half; j++) {
        double *a = rows + j * apart, *b = a + half * apart;
        pair_up(a, a + width, b, b + width, unit + 2 * j * step);
    }
}

MESHONET_CLONES
void fourier_columns(const double *modes, ptrdiff_t m, ptrdiff_t highest, const double *gain, const double *unit,
                   double *columns, ptrdiff_t count, ptrdiff_t width)
{
    for (ptrdiff_t k = -highest; k <= highest; k++) {
        const double factor = gain[k < 0 ? -k : k];
        const double *from = modes + 2 * (k < 0 ? 2 * highest + 1 + k : k);
        double *row = columns + reversed(k & (count - 1), count) * 2 * width;
        for (ptrdiff_t l = 0; l < m; l++, from += 2 * (2 * highest + 1))
            row[l] = factor * from[0], row[width + l] = factor * from[1];
    }
    for (ptrdiff_t l = 0; l < width; l += WIDTH) {
        const ptrdiff_t block = count < BLOCK ? count : BLOCK;
        for (ptrdiff_t a = 0; a < count; a += block)
            for (ptrdiff_t size = 2; size <= block; size *= 2)
                for (ptrdiff_t b = a; b < a + block; b += size)
                    combine(columns + b * 2 * width + l, size, unit, count / size, width);
        for (ptrdiff_t size = 2 * block; size <= count; size *= 2)
            for (ptrdiff_t b = 0; b < count; b += size)
                combine(columns + b * 2 * width + l, size, unit, count / size, width);
    }
}
