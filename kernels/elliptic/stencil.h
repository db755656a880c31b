/* The stencil of Winslow's operator with control functions at one node; see multigrid.c for the equations. */
#pragma once
#include "clones.h"
#include "multigrid.h"

/* What a kernel has to do beside L: a right side, control functions. Constants where it is inlined. */
enum { FORCED = 1, CONTROLLED = 2 };
#define BY_MODE(mode, F, ...) \
    ((mode) == (FORCED | CONTROLLED) ? F(__VA_ARGS__, FORCED | CONTROLLED) \
     : (mode) == CONTROLLED          ? F(__VA_ARGS__, CONTROLLED) \
     : (mode) == FORCED              ? F(__VA_ARGS__, FORCED) \
                                     : F(__VA_ARGS__, 0))

MESHONET_INLINE int mode_of(const Level *g, int forced)
{
    return (forced ? FORCED : 0) | (g->phi.terms + g->psi.terms > 0 ? CONTROLLED : 0);
}

/* Rows i-1, i and i+1 of both coordinates. */
typedef struct {
    const double *restrict xw, *restrict xc, *restrict xe;
    const double *restrict yw, *restrict yc, *restrict ye;
} Rows;

/* Stencil of L at one node: weights of the four neighbours and the cross terms 2β x_ξη, 2β y_ξη. */
typedef struct {
    double east, west, north, south, cross_x, cross_y;
} Stencil;

MESHONET_INLINE Stencil stencil(const Rows *r, ptrdiff_t j, double forward, double backward, double centred,
                                const Differences *eta, double phi, double psi, int mode)
{
    const double ej = eta->centred[j];
    const double x_xi = centred * (r->xe[j] - r->xw[j]), x_eta = ej * (r->xc[j + 1] - r->xc[j - 1]);
    const double y_xi = centred * (r->ye[j] - r->yw[j]), y_eta = ej * (r->yc[j + 1] - r->yc[j - 1]);
    const double alpha = x_eta * x_eta + y_eta * y_eta;
    const double beta = x_xi * x_eta + y_xi * y_eta;
    const double gamma = x_xi * x_xi + y_xi * y_xi;
    const double twice = 2.0 * beta * centred * ej;
    Stencil s;
    if (mode & CONTROLLED) {
        s.east = (forward + centred * phi) * alpha;
        s.west = (backward - centred * phi) * alpha;
        s.north = (eta->forward[j] + ej * psi) * gamma;
        s.south = (eta->backward[j] - ej * psi) * gamma;
    } else {
        s.east = forward * alpha;
        s.west = backward * alpha;
        s.north = eta->forward[j] * gamma;
        s.south = eta->backward[j] * gamma;
    }
    s.cross_x = twice * (r->xe[j + 1] - r->xe[j - 1] - r->xw[j + 1] + r->xw[j - 1]);
    s.cross_y = twice * (r->ye[j + 1] - r->ye[j - 1] - r->yw[j + 1] + r->yw[j - 1]);
    return s;
}

MESHONET_INLINE Rows rows_at(const Level *g, ptrdiff_t i)
{
    const ptrdiff_t ld = g->mj + 1, west = i > 0 ? i - 1 : g->mi - 1, east = i + 1;
    const Rows r = {g->x + west * ld, g->x + i * ld, g->x + east * ld,
                    g->y + west * ld, g->y + i * ld, g->y + east * ld};
    return r;
}

/* Doubles kept for a row of n + 1 nodes, so that rows of scratch begin on cache lines. */
static ptrdiff_t padded(ptrdiff_t n)
{
    return (n + 8) / 8 * 8 + 8;
}

/* Control functions along rows: φ = -(2/h) tanh(h l/2) from the logarithm l of the ratio of steps. A line whose
   steps grow by exp(l h) is then exact on every level, and the weights of both neighbours are positive. */

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
