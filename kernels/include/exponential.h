/* exp in a form that loops are vectorised with. */
#ifndef MESHONET_EXPONENTIAL_H
#define MESHONET_EXPONENTIAL_H

#include "clones.h"
#include <math.h>

/* exp(r) for |r| < .35: Taylor to r^13, 2 ulp */
MESHONET_INLINE double exp_reduced(double r)
{
    double p = 1.0 / 6227020800.0;
    p = p * r + 1.0 / 479001600.0;
    p = p * r + 1.0 / 39916800.0;
    p = p * r + 1.0 / 3628800.0;
    p = p * r + 1.0 / 362880.0;
    p = p * r + 1.0 / 40320.0;
    p = p * r + 1.0 / 5040.0;
    p = p * r + 1.0 / 720.0;
    p = p * r + 1.0 / 120.0;
    p = p * r + 1.0 / 24.0;
    p = p * r + 1.0 / 6.0;
    p = p * r + 0.5;
    p = p * r + 1.0;
    p = p * r + 1.0;
    return p;
}

/* exp(x) for |x| < 700: x = n ln 2 + r, |r| < .347: 2 ulp */
MESHONET_INLINE double fast_exp(double x) {
    double n = rint(x * 1.4426950408889634);
    double r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
    union { double d; long long i; } scale;
    scale.i = (long long)((int)n + 1023) << 52;
    return exp_reduced(r) * scale.d;
}

#endif
