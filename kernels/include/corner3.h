/* Terms of the functionals for volume grids at one corner of a cell.

   With u, v, w the edges along xi, eta and zeta that meet at the corner, each over a length of its direction,
   J = det(u, v, w), g = |u|², h = |v|², q = |w|², and χ = J, or (J + √(J² + ε²)) / 2 when regularised:

       E = a S / χ + b (g h q / χ²)^p [+ c (χ + 1/χ)],    S = |u × v|² + |v × w|² + |w × u|²

   S / J is the density of Winslow's functional, infinite at J = 0; the second term is a power of the inverse squared
   sines of the angles; the third keeps regularised cells from shrinking. dJ/du = v × w, dS/du = 2 ((h + q) u - (u·v) v
   - (u·w) w). Another functional favours cubes, for which it is 1:

       E = (g + h + q) / (3 J^(2/3))

   Ivanenko, Charakch'yan, USSR Comput. Maths. Math. Phys. 28 (1988) 126-133; Garanzha, Comput. Maths. Math. Phys.
   40 (2000) 1617-1637 (regularisation); Knupp, SIAM J. Sci. Comput. 23 (2001) 193-218 (shape, the inverse mean ratio). */
#pragma once
#include "elementary.h"
#include "vectors.h"
#include <math.h>

/* Weights of the terms, times the weight of the place: for the functional with angles' share w, a = (1 - w) / 3 and
   b = w. c, ε² and its inverse are read only where corners are regularised. */
typedef struct {
    double conformal, angle, size, eps2, over_eps2;
} Factors3;

typedef struct {
    Vector du, dv, dw; /* derivatives by the edges */
    double energy, jacobian;
} Corner3;

/* Positive parts of the second derivatives by the edges, a scalar each. */
typedef struct {
    double uu, vv, ww;
} Stiffness3;

typedef struct {
    Vector cu, cv, cw; /* v × w, w × u, u × v */
    double jacobian, g, h, q, uv, uw, vw, inverse, chain; /* chain: dχ/dJ, inverse: 1/χ */
    double conformal, angle, by_angle;                    /* both terms, and (second one) / χ² without one g h q */
} Products3;

MESHONET_INLINE Products3 products3(Vector u, Vector v, Vector w, const Factors3 *f, const int power,
                                    const int regular)
{
    Products3 p;
    p.cu = cross(v, w), p.cv = cross(w, u), p.cw = cross(u, v);
    p.jacobian = dot(u, p.cu);
    p.g = dot(u, u), p.h = dot(v, v), p.q = dot(w, w);
    p.uv = dot(u, v), p.uw = dot(u, w), p.vw = dot(v, w);
    p.inverse = 1.0 / p.jacobian, p.chain = 1.0;
    if (regular) {
        const double root = sqrt(p.jacobian * p.jacobian + f->eps2);
        const double above = 2.0 / (p.jacobian + root), below = 2.0 * (root - p.jacobian) * f->over_eps2;
        p.inverse = p.jacobian < 0.0 ? below : above; /* the same; no digits are lost */
        p.chain = 1.0 / (p.inverse * root);
    }
    const double squares = p.inverse * p.inverse, ratio = p.g * p.h * p.q * squares;
    const double surfaces = p.g * p.h - p.uv * p.uv + p.h * p.q - p.vw * p.vw + p.q * p.g - p.uw * p.uw;
    p.conformal = f->conformal * surfaces * p.inverse;
    p.by_angle = f->angle * squares * (power == 2 ? ratio : 1.0);
    p.angle = p.by_angle * p.g * p.h * p.q;
    return p;
}

/* E at a corner and its derivatives. `power`, 1 or 2, and `regular` are constants at every call. */
MESHONET_INLINE Corner3 corner3(Vector u, Vector v, Vector w, const Factors3 *f, const int power, const int regular)
{
    const Products3 p = products3(u, v, w, f, power, regular);
    const double by_s = 2.0 * f->conformal * p.inverse, by_t = 2.0 * power * p.by_angle;
    const double size = regular ? f->size / p.inverse : 0.0, inverse = regular ? f->size * p.inverse : 0.0;
    const double by_j = -(p.conformal + 2.0 * power * p.angle + inverse - size) * p.inverse * p.chain;
    const double a = by_s * (p.h + p.q) + by_t * p.h * p.q;
    const double b = by_s * (p.g + p.q) + by_t * p.g * p.q;
    const double c = by_s * (p.g + p.h) + by_t * p.g * p.h;
    const double uv = by_s * p.uv, uw = by_s * p.uw, vw = by_s * p.vw;
    Corner3 r;
    r.energy = p.conformal + p.angle + (size + inverse), r.jacobian = p.jacobian;
    r.du = (Vector){a * u.x - uv * v.x - uw * w.x + by_j * p.cu.x, a * u.y - uv * v.y - uw * w.y + by_j * p.cu.y,
                     a * u.z - uv * v.z - uw * w.z + by_j * p.cu.z};
    r.dv = (Vector){b * v.x - uv * u.x - vw * w.x + by_j * p.cv.x, b * v.y - uv * u.y - vw * w.y + by_j * p.cv.y,
                     b * v.z - uv * u.z - vw * w.z + by_j * p.cv.z};
    r.dw = (Vector){c * w.x - uw * u.x - vw * v.x + by_j * p.cw.x, c * w.y - uw * u.y - vw * v.y + by_j * p.cw.y,
                     c * w.z - uw * u.z - vw * v.z + by_j * p.cw.z};
    return r;
}

/* A third of the traces of the positive parts of second derivatives, about: what a preconditioner divides by. */
MESHONET_INLINE Stiffness3 stiffness3(Vector u, Vector v, Vector w, const Factors3 *f, const int power,
                                      const int regular)
{
    const Products3 p = products3(u, v, w, f, power, regular);
    const double by_s = 2.0 * f->conformal * p.inverse, by_t = 2.0 * power * p.by_angle;
    const double bend = p.inverse * p.chain;
    const double by_jj = (2.0 * p.conformal + 2.0 * power * (2.0 * power + 1.0) * p.angle) * bend * bend / 3.0;
    return (Stiffness3){by_s * (p.h + p.q) + by_t * p.h * p.q + by_jj * dot(p.cu, p.cu),
                        by_s * (p.g + p.q) + by_t * p.g * p.q + by_jj * dot(p.cv, p.cv),
                        by_s * (p.g + p.h) + by_t * p.g * p.h + by_jj * dot(p.cw, p.cw)};
}

/* The energy of shapes at a point, times `weight`; nonsense where the Jacobian is not positive. */
MESHONET_INLINE Corner3 shape3(Vector u, Vector v, Vector w, double weight)
{
    const Vector cu = cross(v, w), cv = cross(w, u), cw = cross(u, v);
    const double jacobian = dot(u, cu), by = 2.0 / 3.0 * weight * exp_double(-2.0 / 3.0 * log_double(jacobian));
    const double energy = 0.5 * by * (dot(u, u) + dot(v, v) + dot(w, w));
    const double by_j = -2.0 / 3.0 * energy / jacobian;
    return (Corner3){{by * u.x + by_j * cu.x, by * u.y + by_j * cu.y, by * u.z + by_j * cu.z},
                     {by * v.x + by_j * cv.x, by * v.y + by_j * cv.y, by * v.z + by_j * cv.z},
                     {by * w.x + by_j * cw.x, by * w.y + by_j * cw.y, by * w.z + by_j * cw.z},
                     energy, jacobian};
}

/* As stiffness3, of the energy of shapes. */
MESHONET_INLINE Stiffness3 shape_stiffness3(Vector u, Vector v, Vector w, double weight)
{
    const Vector cu = cross(v, w), cv = cross(w, u), cw = cross(u, v);
    const double jacobian = dot(u, cu), by = 2.0 / 3.0 * weight * exp_double(-2.0 / 3.0 * log_double(jacobian));
    const double by_jj = 5.0 / 27.0 * by * (dot(u, u) + dot(v, v) + dot(w, w)) / (jacobian * jacobian);
    return (Stiffness3){by + by_jj * dot(cu, cu), by + by_jj * dot(cv, cv), by + by_jj * dot(cw, cw)};
}
