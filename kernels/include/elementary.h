/* Polynomials, and elementary functions in a form that compilers vectorise in loops. They consist only of additions,
   products and quotients, so that results are bitwise equal on every processor, unlike those of vector libraries. */
#pragma once
#include "clones.h"
#include <math.h>

/* One instruction each, and vectorised, unlike fabs, fmax and fmin. */
MESHONET_INLINE double magnitude(double value) { return value < 0 ? -value : value; }
MESHONET_INLINE double larger(double a, double b) { return a > b ? a : b; }
MESHONET_INLINE double smaller(double a, double b) { return a < b ? a : b; }

/* c[0] + c[1] x + ... of n coefficients, a constant: without a loop. */
MESHONET_INLINE double polynomial(const double *c, const int n, double x)
{
    double sum = c[n - 1];
#pragma GCC unroll 16
    for (int k = n - 2; k >= 0; k--)
        sum = sum * x + c[k];
    return sum;
}

/* r of x = n ln 2 + r, |r| < .347, for |x| < 700, and 2^n. */
MESHONET_INLINE double reduced(double x, double *scale)
{
    const double n = rint(x * 1.4426950408889634);
    union { double d; long long i; } power;
    power.i = (long long)((int)n + 1023) << 52;
    *scale = power.d;
    return (x - n * 6.93147180369123816490e-01) - n * 1.90821492927058770002e-10;
}

/* exp(x) for |x| < 700: Taylor to r^13: 2 ulp */
MESHONET_INLINE double exp_double(double x)
{
    static const double c[14] = {1.0, 1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0,
                                 1.0 / 40320.0, 1.0 / 362880.0, 1.0 / 3628800.0, 1.0 / 39916800.0, 1.0 / 479001600.0,
                                 1.0 / 6227020800.0};
    double scale;
    const double r = reduced(x, &scale);
    return polynomial(c, 14, r) * scale;
}

/* exp(x) - 1 for |x| < 700: as exp_double, with the 1 taken off where nothing cancels: 2 ulp */
MESHONET_INLINE double expm1_double(double x)
{
    static const double c[13] = {1.0, 0.5, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0,
                                 1.0 / 40320.0, 1.0 / 362880.0, 1.0 / 3628800.0, 1.0 / 39916800.0, 1.0 / 479001600.0,
                                 1.0 / 6227020800.0};
    double scale;
    const double r = reduced(x, &scale);
    return scale * (r * polynomial(c, 13, r)) + (scale - 1.0);
}

/* tanh(x) for |x| < 300: 3 ulp */
MESHONET_INLINE double tanh_double(double x)
{
    const double more = expm1_double(2.0 * (x < 0.0 ? -x : x)), size = more / (more + 2.0);
    return x < 0.0 ? -size : size;
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

/* sin and cos for |x| < 1e5: quadrant by rounding, Cody & Waite reduction, Taylor on |r| < pi/4: 2 ulp */
MESHONET_INLINE void sincos_double(double x, double *s, double *c)
{
    static const double sine[7] = {-1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0, -1.0 / 39916800.0,
                                   1.0 / 6227020800.0, -1.0 / 1307674368000.0};
    static const double cosine[8] = {-0.5, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0, -1.0 / 3628800.0,
                                     1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0};
    const double n = rint(x * 0.63661977236758134308);
    const double r = ((x - n * 1.57079632673412561417e+00) - n * 6.07710050630396597660e-11)
                     - n * 2.02226624879595063154e-21;
    const double z = r * r, ps = r + r * z * polynomial(sine, 7, z), pc = 1.0 + z * polynomial(cosine, 8, z);
    const int quadrant = (int)n & 3;
    const double a = (quadrant & 1) ? pc : ps, b = (quadrant & 1) ? ps : pc;
    *s = (quadrant & 2) ? -a : a;
    *c = ((quadrant + 1) & 2) ? -b : b;
}

/* The angle of (x, y) from -pi to pi, 0 of (0, 0). The smaller coordinate over the larger is the tangent of at most
   pi/4; taken from it is the arc of 0, 1/2 or 1, known to twice the digits, and of the rest atan is the polynomial of
   Sun's fdlibm (s_atan.c, 1993): 2 ulp */
MESHONET_INLINE double angle_double(double y, double x)
{
    static const double c[11] = {3.33333333333329318027e-01, -1.99999999998764832476e-01, 1.42857142725034663711e-01,
                                 -1.11111104054623557880e-01, 9.09088713343650656196e-02, -7.69187620504482999495e-02,
                                 6.66107313738753120669e-02, -5.83357013379057348645e-02, 4.97687799461593236017e-02,
                                 -3.65315727442169155270e-02, 1.62858201153657823623e-02};
    const double width = x < 0.0 ? -x : x, height = y < 0.0 ? -y : y;
    const int steep = width < height;
    const double low = steep ? width : height, high = steep ? height : width;
    const int half = low > 0.4375 * high, whole = low > 0.6875 * high;
    const double tangent = whole ? 1.0 : half ? 0.5 : 0.0;
    const double arc = whole ? 7.85398163397448278999e-01 : half ? 4.63647609000806093515e-01 : 0.0;
    const double rest = whole ? 3.06161699786838301793e-17 : half ? 2.26987774529616870924e-17 : 0.0;
    const double across = high + tangent * low, t = (low - tangent * high) / (across > 0.0 ? across : 1.0), z = t * t;
    const double acute = arc - ((t * z * polynomial(c, 11, z) - rest) - t);
    const double ahead = steep ? (1.57079632679489655800 - acute) + 6.12323399573676603587e-17 : acute;
    const double above = x < 0.0 ? (3.14159265358979311600 - ahead) + 1.22464679914735317723e-16 : ahead;
    return y < 0.0 ? -above : above;
}
