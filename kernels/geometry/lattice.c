#include "lattice.h"

#include <math.h>

#define TAPS 4

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

void lattice_values(const double *table, ptrdiff_t n, ptrdiff_t m, ptrdiff_t width, const double *u, const double *v,
                    ptrdiff_t count, double *out)
{
    const int across = m < TAPS ? 1 : TAPS;
    for (ptrdiff_t p = 0; p < count; p++) {
        double along[TAPS], over[TAPS] = {1.0};
        const ptrdiff_t i = weights(u[p], n, along), j = across == 1 ? 0 : weights(v[p], m, over);
        for (ptrdiff_t c = 0; c < width; c++)
            out[p * width + c] = 0.0;
        for (int a = 0; a < TAPS; a++)
            for (int b = 0; b < across; b++) {
                const double w = along[a] * over[b], *node = table + ((i + a) * m + j + b) * width;
                for (ptrdiff_t c = 0; c < width; c++)
                    out[p * width + c] += w * node[c];
            }
    }
}
