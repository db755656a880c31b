/* The inner part of exp, shared by kernels that reduce the argument each in its own way. */
#ifndef MESHONET_EXPONENTIAL_H
#define MESHONET_EXPONENTIAL_H

#include "clones.h"

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

#endif
