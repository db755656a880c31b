#include "lattice.h"

#include <math.h>

#define TAPS 4
#define WIDEST 8 /* values of a node that are summed at a time */

/* Lagrange's weights of four nodes at `place`, and the first of these */
static ptrdiff_t weights(double place, ptrdiff_t n, double *w)
{
    const double last = (double)(n - TAPS);
    double first = floor(place) - 1.0;
    first = first > 0.0 ? first : 0.0;
    first = first < last ? first : last;
    const double f = place - first;
    w[0] = -(f - 1.0) * (f - 2.0) * (f - 3.0) / 6.0;
    w[1] = f * (f - 2.0) * (f - 3.0) / 2.0;
    w[2] = -f * (f - 1.0) * (f - 3.0) / 2.0;
    w[3] = f * (f - 1.0) * (f - 2.0) / 6.0;
    return (ptrdiff_t)first;
}

/* As lattice_values; of tables whose width the compiler knows the sums stay in registers. */
static inline void sums(const double *table, ptrdiff_t n, ptrdiff_t m, ptrdiff_t width, const double *u, const double *v,
                        ptrdiff_t count, double *out)
{
    const int across = m < TAPS ? 1 : TAPS;
    for (ptrdiff_t p = 0; p < count; p++) {
        double along[TAPS], over[TAPS] = {1.0}, sum[WIDEST] = {0.0};
        const ptrdiff_t i = weights(u[p], n, along), j = across == 1 ? 0 : weights(v[p], m, over);
        for (ptrdiff_t start = 0; start < width; start += WIDEST) {
            const ptrdiff_t some = width - start < WIDEST ? width - start : WIDEST;
            for (ptrdiff_t c = 0; c < some; c++)
                sum[c] = 0.0;
            for (int a = 0; a < TAPS; a++)
                for (int b = 0; b < across; b++) {
                    const double w = along[a] * over[b], *node = table + ((i + a) * m + j + b) * width + start;
                    for (ptrdiff_t c = 0; c < some; c++)
                        sum[c] += w * node[c];
                }
            for (ptrdiff_t c = 0; c < some; c++)
                out[p * width + start + c] = sum[c];
        }
    }
}

void lattice_values(const double *table, ptrdiff_t n, ptrdiff_t m, ptrdiff_t width, const double *u, const double *v,
                    ptrdiff_t count, double *out)
{
    if (width == 1)
        sums(table, n, m, 1, u, v, count, out);
    else if (width == 2)
        sums(table, n, m, 2, u, v, count, out);
    else if (width == 3)
        sums(table, n, m, 3, u, v, count, out);
    else
        sums(table, n, m, width, u, v, count, out);
}
