/* Terms that the functionals of functional.h (blocks) and quads/energy.c (quads with shared nodes) have in common: those of
   one corner of a cell, and the logarithm of a length. */
#pragma once
#include "elementary.h"
#include <stdint.h>
#include <string.h>

typedef struct {
    double du_x, du_y, dv_x, dv_y, energy, jacobian;
} Corner;

typedef struct {
    double along, across, angle, eps2; /* (1-w) a / 2, (1-w) / (2a) and w, times the weight of the place; ε² */
} Factors;

MESHONET_INLINE Corner corner(double ux, double uy, double vx, double vy, const Factors *f, int regular)
{
    Corner c;
    const double g = ux * ux + uy * uy, h = vx * vx + vy * vy;
    c.jacobian = ux * vy - uy * vx;
    const double root = regular ? sqrt(c.jacobian * c.jacobian + f->eps2) : c.jacobian;
    const double inverse = regular ? 2.0 / (c.jacobian + root) : 1.0 / c.jacobian;
    const double chain = regular ? 0.5 * (1.0 + c.jacobian / root) : 1.0; /* dχ/dJ */
    const double harmonic = (f->along * g + f->across * h) * inverse;
    const double squares = inverse * inverse, ratio = g * h * squares, angle = f->angle * ratio * ratio;
    const double by_angle = 2.0 * f->angle * ratio * squares;
    const double by_g = 2.0 * (f->along * inverse + by_angle * h), by_h = 2.0 * (f->across * inverse + by_angle * g);
    const double by_j = -(harmonic + 4.0 * angle) * inverse * chain;
    c.energy = harmonic + angle;
    c.du_x = by_g * ux + by_j * vy, c.du_y = by_g * uy - by_j * vx;
    c.dv_x = by_h * vx - by_j * uy, c.dv_y = by_h * vy + by_j * ux;
    return c;
}

/* Natural logarithm of a positive normal number, to 2 units of the last place, and its inverse, without a branch and
   with one division: x = 2^k m with m in [√½, √2), log m = 2 artanh s, s = (m - 1) / (m + 1). */
MESHONET_INLINE double logarithm(double x, double *inverse)
{
    static const double c[9] = {1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0, 1.0 / 9.0, 1.0 / 11.0, 1.0 / 13.0, 1.0 / 15.0,
                                1.0 / 17.0, 1.0 / 19.0};
    uint64_t bits, power;
    double m, k;
    memcpy(&bits, &x, sizeof bits);
    power = (bits - 0x3fe6a09e667f3bcdULL + 0x3ff0000000000000ULL) >> 52; /* k + 1023 */
    bits -= (power << 52) - 0x3ff0000000000000ULL;
    memcpy(&m, &bits, sizeof m);
    power |= 0x4330000000000000ULL; /* 2^52 + k + 1023 as a double */
    memcpy(&k, &power, sizeof k);
    k -= 4503599627371519.0;
    const double both = 1.0 / (x * (m + 1.0)), s = (m - 1.0) * x * both, q = s * s;
    *inverse = (m + 1.0) * both;
    return k * 0.69314718055994530942 + 2.0 * s * (1.0 + q * polynomial(c, 9, q));
}
