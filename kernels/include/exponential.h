/* Polynomials, and exp in a form that loops are vectorised with. */
#pragma once
#include "clones.h"
#include <math.h>

/* c[0] + c[1] x + ... of n coefficients, a constant: without a loop. */
MESHONET_INLINE double polynomial(const double *c, const int n, double x)
{
    double sum = c[n - 1];
#pragma GCC unroll 16
    for (int k = n - 2; k >= 0; k--)
        sum = sum * x + c[k];
    return sum;
}

/* exp(x) for |x| < 700: x = n ln 2 + r, |r| < .347, and Taylor to r^13: 2 ulp */
MESHONET_INLINE double exp_double(double x)
{
    static const double c[14] = {1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0,
                                 1.0 / 40320.0, 1.0 / 362880.0, 1.0 / 3628800.0, 1.0 / 39916800.0, 1.0 / 479001600.0,
                                 1.0 / 6227020800.0};
    const double n = rint(x * 1.4426950408889634);
    const double r = (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
    union { double d; long long i; } scale;
    scale.i = (long long)((int)n + 1023) << 52;
    return polynomial(c, 14, r) * scale.d;
}
