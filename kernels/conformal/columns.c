/* A fast Fourier transform of many sums at once: a row holds one mode, later one column, of all of them, so that
   every operation is one on whole rows. Modes are put where their reversed bits say; Cooley & Tukey (1965). */

#include "columns.h"

#include "clones.h"
#include "lanes.h"

#define BLOCK 128 /* rows that stay in the first-level cache while they are combined with each other */

#if defined(__GNUC__)
#define WIDTH LANES
typedef Lanes Some;
#else
#define WIDTH 1
typedef double Some;
#endif
#define SOME(p) (*(Some *)(p))

MESHONET_INLINE ptrdiff_t reversed(ptrdiff_t k, ptrdiff_t count)
{
    ptrdiff_t r = 0;
    for (ptrdiff_t bit = 1; bit < count; bit *= 2) r = 2 * r + ((k & bit) != 0);
    return r;
}

/* Transforms of `size` rows from those of their halves: a, b <- a + u b, a - u b. */
MESHONET_INLINE void combine(double *rows, ptrdiff_t size, const double *unit, ptrdiff_t step, ptrdiff_t width)
{
    const ptrdiff_t half = size / 2, apart = 2 * width;
    for (ptrdiff_t j = 0; j < half; j++) {
        const double wr = unit[2 * j * step], wi = unit[2 * j * step + 1];
        double *ar = rows + j * apart, *ai = ar + width, *br = ar + half * apart, *bi = br + width;
        const Some b = SOME(br), c = SOME(bi), tr = wr * b - wi * c, ti = wr * c + wi * b, r = SOME(ar), i = SOME(ai);
        SOME(br) = r - tr, SOME(bi) = i - ti;
        SOME(ar) = r + tr, SOME(ai) = i + ti;
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
