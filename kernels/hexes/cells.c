/* The terms of the corners of a row of cells: whole vectors of cells where all corners count, else one by one. */
#include "cells.h"
#include "clones.h"
#include <math.h>
#include <string.h>

MESHONET_INLINE Vector edge3(const CellRow *r, int from, ptrdiff_t k, int to, ptrdiff_t l, double scale)
{
    return (Vector){(r->x[to][l] - r->x[from][k]) * scale, (r->y[to][l] - r->y[from][k]) * scale,
                     (r->z[to][l] - r->z[from][k]) * scale};
}

MESHONET_INLINE void add3(Vector *sum, Vector v)
{
    sum->x += v.x, sum->y += v.y, sum->z += v.z;
}

MESHONET_INLINE Vector with3(Vector a, Vector b, double by)
{
    return (Vector){a.x + by * b.x, a.y + by * b.y, a.z + by * b.z};
}

/* A corner, with the term in brackets of energy.c where it is regularised. */
MESHONET_INLINE Corner3 one_corner(Vector u, Vector v, Vector w, const Factors3 *f, double size, const int power,
                                   const int regular)
{
    Corner3 at = corner3(u, v, w, f, power, regular);
    if (regular) {
        const double jacobian = at.jacobian, root = sqrt(jacobian * jacobian + f->eps2);
        const double above = 0.5 * (jacobian + root), below = 0.5 * f->eps2 / (root - jacobian);
        const double chi = jacobian < 0.0 ? below : above, over = 1.0 / chi;
        const double by_j = size * (1.0 - over * over) * chi / root;
        at.energy += size * (chi + over);
        at.du = with3(at.du, cross(v, w), by_j), at.dv = with3(at.dv, cross(w, u), by_j);
        at.dw = with3(at.dw, cross(u, v), by_j);
    }
    return at;
}

MESHONET_INLINE double whole_row(CellRow *restrict r, ptrdiff_t count, const Terms *t, const int power, const int regular)
{
    const Factors3 factors = t->factors;
    const double size = t->size;
    double energy = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < count; k++) {
        const double su = r->inverse[0][k], sv = r->inverse[1][k], sw = r->inverse[2][k];
        /* u by (beta, gamma), v by (alpha, gamma), w by (alpha, beta) */
        Vector u[4], v[4], w[4], fu[4] = {{0}}, fv[4] = {{0}}, fw[4] = {{0}};
#pragma GCC unroll 4
        for (int e = 0; e < 4; e++) {
            const int first = e >> 1, second = e & 1;
            u[e] = edge3(r, first, k + second, 2 + first, k + second, su);
            v[e] = edge3(r, 2 * first, k + second, 2 * first + 1, k + second, sv);
            w[e] = edge3(r, e, k, e, k + 1, sw);
        }
        double least = INFINITY;
#pragma GCC unroll 8
        for (int c = 0; c < 8; c++) {
            const int alpha = c >> 2, beta = c >> 1 & 1, gamma = c & 1;
            const int eu = 2 * beta + gamma, ev = 2 * alpha + gamma, ew = 2 * alpha + beta;
            const Corner3 at = one_corner(u[eu], v[ev], w[ew], &factors, size, power, regular);
            energy += at.energy;
            least = at.jacobian < least ? at.jacobian : least;
            add3(fu + eu, at.du), add3(fv + ev, at.dv), add3(fw + ew, at.dw);
        }
        r->least[k] = least;
#pragma GCC unroll 8
        for (int c = 0; c < 8; c++) {
            const int alpha = c >> 2, beta = c >> 1 & 1, gamma = c & 1;
            const int eu = 2 * beta + gamma, ev = 2 * alpha + gamma, ew = 2 * alpha + beta;
            const double du = alpha ? su : -su, dv = beta ? sv : -sv, dw = gamma ? sw : -sw;
            r->fx[c][k] = du * fu[eu].x + dv * fv[ev].x + dw * fw[ew].x;
            r->fy[c][k] = du * fu[eu].y + dv * fv[ev].y + dw * fw[ew].y;
            r->fz[c][k] = du * fu[eu].z + dv * fv[ev].z + dw * fw[ew].z;
        }
    }
    return energy;
}

MESHONET_CLONES
static double regular_row(CellRow *r, ptrdiff_t count, const Terms *t)
{
    return whole_row(r, count, t, 1, 1);
}

MESHONET_CLONES
static double valid_row(CellRow *r, ptrdiff_t count, const Terms *t)
{
    return whole_row(r, count, t, 2, 0);
}

/* The three edges at corner c of cell k. */
static void edges_at(const CellRow *r, ptrdiff_t k, int c, Vector edge[3])
{
    const int alpha = c >> 2, beta = c >> 1 & 1, gamma = c & 1;
    edge[0] = edge3(r, beta, k + gamma, 2 + beta, k + gamma, r->inverse[0][k]);
    edge[1] = edge3(r, 2 * alpha, k + gamma, 2 * alpha + 1, k + gamma, r->inverse[1][k]);
    edge[2] = edge3(r, 2 * alpha + beta, k, 2 * alpha + beta, k + 1, r->inverse[2][k]);
}

/* Add a force by the edge between corners of cell k, `scale` of which it is. */
static void add_force(CellRow *r, ptrdiff_t k, int from, int to, Vector force, double scale)
{
    r->fx[from][k] -= scale * force.x, r->fy[from][k] -= scale * force.y, r->fz[from][k] -= scale * force.z;
    r->fx[to][k] += scale * force.x, r->fy[to][k] += scale * force.y, r->fz[to][k] += scale * force.z;
}

static double mixed_row(CellRow *r, ptrdiff_t count, const Terms *t)
{
    double energy = 0.0;
    for (int c = 0; c < 8; c++)
        for (ptrdiff_t k = 0; k < count; k++)
            r->fx[c][k] = r->fy[c][k] = r->fz[c][k] = 0.0;
    for (ptrdiff_t k = 0; k < count; k++) {
        r->least[k] = INFINITY;
        for (int c = 0; c < 8; c++) {
            if (r->skip[k] >> c & 1)
                continue;
            Vector e[3];
            edges_at(r, k, c, e);
            const Corner3 at = t->regular ? one_corner(e[0], e[1], e[2], &t->factors, t->size, 1, 1)
                                          : one_corner(e[0], e[1], e[2], &t->factors, t->size, 2, 0);
            energy += at.energy;
            r->least[k] = at.jacobian < r->least[k] ? at.jacobian : r->least[k];
            add_force(r, k, c & 3, c | 4, at.du, r->inverse[0][k]);
            add_force(r, k, c & 5, c | 2, at.dv, r->inverse[1][k]);
            add_force(r, k, c & 6, c | 1, at.dw, r->inverse[2][k]);
        }
    }
    return energy;
}

double cells_of_row(CellRow *r, ptrdiff_t count, const Terms *t)
{
    if (r->skip)
        return mixed_row(r, count, t);
    return t->regular ? regular_row(r, count, t) : valid_row(r, count, t);
}

MESHONET_CLONES
static void whole_row_stiffness(CellRow *restrict r, ptrdiff_t count, const Terms *t)
{
    const Factors3 factors = t->factors;
    const int power = t->power;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < count; k++) {
        const double su = r->inverse[0][k], sv = r->inverse[1][k], sw = r->inverse[2][k];
        double sum[8] = {0.0};
#pragma GCC unroll 8
        for (int c = 0; c < 8; c++) {
            const int alpha = c >> 2, beta = c >> 1 & 1, gamma = c & 1;
            const Vector u = edge3(r, beta, k + gamma, 2 + beta, k + gamma, su);
            const Vector v = edge3(r, 2 * alpha, k + gamma, 2 * alpha + 1, k + gamma, sv);
            const Vector w = edge3(r, 2 * alpha + beta, k, 2 * alpha + beta, k + 1, sw);
            const Stiffness3 at = stiffness3(u, v, w, &factors, power, 1);
            const double along = at.uu * su * su, across = at.vv * sv * sv, up = at.ww * sw * sw;
            sum[c] += along + across + up;
            sum[c ^ 4] += along, sum[c ^ 2] += across, sum[c ^ 1] += up;
        }
#pragma GCC unroll 8
        for (int c = 0; c < 8; c++)
            r->fx[c][k] = sum[c];
    }
}

static void mixed_row_stiffness(CellRow *r, ptrdiff_t count, const Terms *t)
{
    for (int c = 0; c < 8; c++)
        memset(r->fx[c], 0, (size_t)count * sizeof(double));
    for (ptrdiff_t k = 0; k < count; k++)
        for (int c = 0; c < 8; c++) {
            if (r->skip[k] >> c & 1)
                continue;
            Vector e[3];
            edges_at(r, k, c, e);
            const Stiffness3 at = stiffness3(e[0], e[1], e[2], &t->factors, t->power, 1);
            const double along = at.uu * r->inverse[0][k] * r->inverse[0][k];
            const double across = at.vv * r->inverse[1][k] * r->inverse[1][k];
            const double up = at.ww * r->inverse[2][k] * r->inverse[2][k];
            r->fx[c][k] += along + across + up;
            r->fx[c ^ 4][k] += along, r->fx[c ^ 2][k] += across, r->fx[c ^ 1][k] += up;
        }
}

void stiffness_of_row(CellRow *r, ptrdiff_t count, const Terms *t)
{
    if (r->skip)
        mixed_row_stiffness(r, count, t);
    else
        whole_row_stiffness(r, count, t);
}
