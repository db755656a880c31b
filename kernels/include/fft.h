/* Fast Fourier transforms of many series at once: a row holds one mode, later one column, of all of them, so that every
   operation is one on whole rows. Modes lie where their reversed bits say; Cooley & Tukey (1965). */
#ifndef MESHONET_FFT_H
#define MESHONET_FFT_H
#include "clones.h"
#include "lanes.h"
#include <stddef.h>

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

/* a, b <- a + u b, a - u b, for WIDTH series. */
MESHONET_INLINE void pair_up(double *ar, double *ai, double *br, double *bi, const double *unit)
{
    const double wr = unit[0], wi = unit[1];
    const Some b = SOME(br), c = SOME(bi), tr = wr * b - wi * c, ti = wr * c + wi * b, r = SOME(ar), i = SOME(ai);
    SOME(br) = r - tr, SOME(bi) = i - ti;
    SOME(ar) = r + tr, SOME(ai) = i + ti;
}

/* a, b <- a + b, (a - b) / u */
MESHONET_INLINE void pair_down(double *ar, double *ai, double *br, double *bi, const double *unit)
{
    const double wr = unit[0], wi = -unit[1];
    const Some tr = SOME(ar) - SOME(br), ti = SOME(ai) - SOME(bi);
    SOME(ar) += SOME(br), SOME(ai) += SOME(bi);
    SOME(br) = wr * tr - wi * ti, SOME(bi) = wr * ti + wi * tr;
}

#endif
