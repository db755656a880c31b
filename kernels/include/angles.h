/* Angles in degrees, in a form that compilers vectorise in loops. */
#pragma once
#include "elementary.h"

#define DEGREES 57.295779513082320876798154814105170332

/* asin(s)/s as a polynomial in z = s*s on [0, 1/4]: Chebyshev interpolation of degree 12, relative error 3e-17. */
MESHONET_INLINE double asin_over_s(double z)
{
    static const double c[13] = {1.0, 0.16666666666664945, 0.07500000000384784, 0.044642856806216,
                                 0.030381959691850167, 0.02237174983251582, 0.017359778450540774, 0.013884853387846141,
                                 0.012170069419059097, 0.006529622403221694, 0.01951249342600702, -0.016185667777976222,
                                 0.03187828814012674};
    return polynomial(c, 13, z);
}

/* Angle in degrees of a cosine. acos in the C library is a call, which would stop vectorisation. */
MESHONET_INLINE double angle(double cosine)
{
    double u = smaller(magnitude(cosine), 1.0);
    double z = smaller(0.5 * (1.0 - u), u * u); /* half-angle formula beyond 1/2, where the series would be slow */
    double s = __builtin_sqrt(z);
    double inner = s * asin_over_s(z) * DEGREES;
    double acute = u > 0.5 ? 2.0 * inner : 90.0 - inner; /* acos(|cosine|) */
    return cosine < 0 ? 180.0 - acute : acute;
}
