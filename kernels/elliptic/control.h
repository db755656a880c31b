/* Control functions evaluated along rows: φ = -(2/h) tanh(h l/2) from the logarithm l of the ratio of steps.

   With this a line whose steps h grow by exp(l h) satisfies  x_ξξ + φ x_ξ = 0  exactly by central differences, on
   every level, and the weights of both neighbours stay positive however large l is. */
#pragma once
#include "stencil.h"

/* tanh to 2e-7 for |z| < 1/2 and 5e-4 elsewhere, below 1 always: a quotient that vectorises. */
MESHONET_INLINE double soft_sign(double z)
{
    const double q = z * z;
    const double t = z * (945.0 + q * (105.0 + q)) / (945.0 + q * (420.0 + 15.0 * q));
    return t > 0.999 ? 0.999 : t < -0.999 ? -0.999 : t;
}

/* out[k] = Σ_t along[t][i] across[t][first + stride k], k < n */
MESHONET_INLINE void control_sum(const Level *g, const Control *c, ptrdiff_t i, ptrdiff_t first, ptrdiff_t stride,
                                 ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++)
        out[k] = 0.0;
    for (ptrdiff_t t = 0; t < c->terms; t++) {
        const double a = c->along[t * (g->mi + 1) + i];
        const double *restrict b = c->across + t * (g->mj + 1) + first;
        if (a != 0.0)
            for (ptrdiff_t k = 0; k < n; k++)
                out[k] += a * b[stride * k];
    }
}

/* phi[k], psi[k] at the nodes (i, first + stride k), k < n */
MESHONET_INLINE void control_row(const Level *g, ptrdiff_t i, ptrdiff_t first, ptrdiff_t stride, ptrdiff_t n,
                                 double *restrict phi, double *restrict psi)
{
    control_sum(g, &g->phi, i, first, stride, n, phi);
    if (g->phi.terms > 0) {
        const double h = g->phi.reach[i];
        for (ptrdiff_t k = 0; k < n; k++)
            phi[k] = -2.0 / h * soft_sign(0.5 * h * phi[k]);
    }
    control_sum(g, &g->psi, i, first, stride, n, psi);
    if (g->psi.terms > 0) {
        const double *restrict reach = g->psi.reach + first;
        for (ptrdiff_t k = 0; k < n; k++) {
            const double h = reach[stride * k];
            psi[k] = -2.0 / h * soft_sign(0.5 * h * psi[k]);
        }
    }
}
