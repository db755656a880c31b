/* Polynomials, and exp and log in a form that loops are vectorised with. */
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

/* ln(x) for normal x > 0: x = 2^n m, 1/sqrt(2) <= m < sqrt(2), and the series of atanh((m - 1)/(m + 1)): 2 ulp */
MESHONET_INLINE double log_double(double x)
{
    static const double c[11] = {1.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0,
                                 1.0 / 17.0, 1.0 / 19.0, 1.0 / 21.0};
    union { double d; unsigned long long i; } bits = {x}, part;
    const unsigned long long above = bits.i + (0x3ff0000000000000ULL - 0x3fe6a09e667f3bcdULL);
    const int n = (int)(above >> 52) - 1023;
    part.i = (above & 0x000fffffffffffffULL) + 0x3fe6a09e667f3bcdULL;
    const double s = (part.d - 1.0) / (part.d + 1.0);
    return 2.0 * s * polynomial(c, 11, s * s) + (double)n * 0.69314718055994530942;
}
