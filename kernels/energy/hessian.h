/* Second derivatives of the functional by the inner nodes of a grid, as the lower triangle of a banded matrix, and its
   Cholesky factor, in single precision. Without ∇²J, ∇²c and ∇²log l in the Hessian of

       A g / J (and so h),  f(c) = w (1 + c²)², c = (u·v) / J = cot of the angle,  Σ β (Δ log l)²

   the rest is positive semi-definite (Gauss-Newton); the fraction `bent` of them is added. */
#pragma once
#include "clones.h"
#include "functional.h"
#include "spectral.h"
#include "sums.h"
#include <math.h>
#include <string.h>

#define TOGETHER 4 /* columns that are taken off those behind them at once */

/* Blocks of a corner for (u, u), (u, v) and (v, v), each (2, 2) by rows; the first and the last are symmetric. */
typedef struct {
    double uu[4], uv[4], vv[4];
} Bends;

MESHONET_INLINE void bend_corner(const double *u, const double *v, const Factors *f, double bent, Bends *to)
{
    const double g = u[0] * u[0] + u[1] * u[1], h = v[0] * v[0] + v[1] * v[1];
    const double inverse = 1.0 / (u[0] * v[1] - u[1] * v[0]), squares = inverse * inverse;
    const double c = (u[0] * v[0] + u[1] * v[1]) * inverse, sine = 1.0 + c * c; /* 1 / sin² */
    const double ju[2] = {v[1], -v[0]}, jv[2] = {-u[1], u[0]}; /* ∇J */
    const double harmonic = f->along * g + f->across * h;
    /* the harmonic term */
    const double gj = -2.0 * f->along * squares, hj = -2.0 * f->across * squares, jj = 2.0 * harmonic * squares * inverse;
    /* f''(c) ∇c ∇cᵀ + bent f'(c) ∇²c with ∇c = ((v, u) - c ∇J) / J and
       ∇²c = (∇²(u·v) - ∇c ∇Jᵀ - ∇J ∇cᵀ - c ∇²J) / J */
    const double second = f->angle * (4.0 + 12.0 * c * c), first = bent * f->angle * 4.0 * c * sine * inverse;
    double cu[2], cv[2];
    for (int k = 0; k < 2; k++)
        cu[k] = (v[k] - c * ju[k]) * inverse, cv[k] = (u[k] - c * jv[k]) * inverse;
    for (int k = 0; k < 2; k++)
        for (int l = 0; l < 2; l++) {
            const int at = 2 * k + l;
            to->uu[at] = gj * (u[k] * ju[l] + ju[k] * u[l]) + jj * ju[k] * ju[l] + second * cu[k] * cu[l] -
                         first * (cu[k] * ju[l] + ju[k] * cu[l]);
            to->vv[at] = hj * (v[k] * jv[l] + jv[k] * v[l]) + jj * jv[k] * jv[l] + second * cv[k] * cv[l] -
                         first * (cv[k] * jv[l] + jv[k] * cv[l]);
            to->uv[at] = gj * u[k] * jv[l] + hj * ju[k] * v[l] + jj * ju[k] * jv[l] + second * cu[k] * cv[l] -
                         first * (cu[k] * jv[l] + ju[k] * cv[l]);
        }
    for (int k = 0; k < 4; k += 3)
        to->uu[k] += 2.0 * f->along * inverse, to->vv[k] += 2.0 * f->across * inverse, to->uv[k] += first;
    const double by_j = -bent * harmonic * squares - first * c; /* of ∇²J */
    to->uv[1] += by_j, to->uv[2] -= by_j;
}

/* Add the block (2, 2) to that of nodes p and q, counted by rows of inner nodes; either may be fixed: -1. */
MESHONET_INLINE void add_block(const Band *b, ptrdiff_t p, ptrdiff_t q, const double *block)
{
    if (q < 0 || p < q)
        return;
    float *left = b->column + 2 * q * b->stride + 2 * (p - q), *right = left + b->stride - 1;
    left[0] += (float)block[0], left[1] += (float)block[2];
    if (p > q)
        right[0] += (float)block[1];
    right[1] += (float)block[3];
}

MESHONET_INLINE ptrdiff_t inner_node(const Band *b, ptrdiff_t i, ptrdiff_t j)
{
    return i > 0 && i <= b->mi && j > 0 && j <= b->mj ? (i - 1) * b->mj + j - 1 : -1;
}

/* Add what the cell at (i, j) has. */
MESHONET_INLINE void bend_cell(const double *x, const double *y, ptrdiff_t nj, ptrdiff_t i, ptrdiff_t j,
                               const Factors *at_corner, const Factors *at_centre, double bent, const Band *b)
{
    const ptrdiff_t k = i * nj + j, e = k + nj;
    const double s[2] = {x[e] - x[k], y[e] - y[k]}, n[2] = {x[e + 1] - x[k + 1], y[e + 1] - y[k + 1]};
    const double w[2] = {x[k + 1] - x[k], y[k + 1] - y[k]}, t[2] = {x[e + 1] - x[e], y[e + 1] - y[e]};
    const double u[2] = {s[0] + n[0], s[1] + n[1]}, v[2] = {w[0] + t[0], w[1] + t[1]};
    const ptrdiff_t node[4] = {inner_node(b, i, j), inner_node(b, i, j + 1), inner_node(b, i + 1, j),
                               inner_node(b, i + 1, j + 1)};
    /* the edges of each node, of south, north, west and east, and whether they end there */
    static const int edge[4][2] = {{0, 2}, {1, 2}, {0, 3}, {1, 3}};
    static const double sign[4][2] = {{-1, -1}, {-1, 1}, {1, -1}, {1, 1}};
    double edges[4][4][4];
    Bends sw, se, ne, nw, m;
    bend_corner(s, w, at_corner, bent, &sw), bend_corner(s, t, at_corner, bent, &se);
    bend_corner(n, t, at_corner, bent, &ne), bend_corner(n, w, at_corner, bent, &nw);
    bend_corner(u, v, at_centre, bent, &m);
    for (int l = 0; l < 4; l++) {
        const int turned = l == 1 ? 2 : l == 2 ? 1 : l;
        edges[0][0][l] = sw.uu[l] + se.uu[l] + m.uu[l], edges[1][1][l] = ne.uu[l] + nw.uu[l] + m.uu[l];
        edges[2][2][l] = sw.vv[l] + nw.vv[l] + m.vv[l], edges[3][3][l] = se.vv[l] + ne.vv[l] + m.vv[l];
        edges[0][1][l] = edges[1][0][l] = m.uu[l], edges[2][3][l] = edges[3][2][l] = m.vv[l];
        edges[0][2][l] = edges[2][0][turned] = sw.uv[l] + m.uv[l];
        edges[0][3][l] = edges[3][0][turned] = se.uv[l] + m.uv[l];
        edges[1][2][l] = edges[2][1][turned] = nw.uv[l] + m.uv[l];
        edges[1][3][l] = edges[3][1][turned] = ne.uv[l] + m.uv[l];
    }
#pragma GCC unroll 4
    for (int p = 0; p < 4; p++)
#pragma GCC unroll 4
        for (int q = 0; q <= p; q++) {
            double block[4] = {0.0, 0.0, 0.0, 0.0};
#pragma GCC unroll 2
            for (int a = 0; a < 2; a++)
#pragma GCC unroll 2
                for (int c = 0; c < 2; c++)
#pragma GCC unroll 4
                    for (int l = 0; l < 4; l++)
                        block[l] += sign[p][a] * sign[q][c] * edges[edge[p][a]][edge[q][c]][l];
            add_block(b, node[p], node[q], block);
        }
}

/* An edge of a family, and derivatives of log l by where it ends; `from` is -1 where that is fixed. */
typedef struct {
    ptrdiff_t from, to;
    double length, x, y, same, cross; /* log l, ∇log l and ∇²log l = (same, cross; cross, -same) */
} Edge;

MESHONET_INLINE Edge edge_at(const double *x, const double *y, ptrdiff_t nj, ptrdiff_t i, ptrdiff_t j, int along_i,
                             const Band *b)
{
    const ptrdiff_t k = i * nj + j, next = along_i ? nj : 1;
    const double dx = x[k + next] - x[k], dy = y[k + next] - y[k];
    double one;
    Edge e = {inner_node(b, i, j), along_i ? inner_node(b, i + 1, j) : inner_node(b, i, j + 1), 0, 0, 0, 0, 0};
    e.length = 0.5 * logarithm(dx * dx + dy * dy, &one);
    e.x = one * dx, e.y = one * dy;
    e.same = one - 2.0 * e.x * e.x, e.cross = -2.0 * e.x * e.y;
    return e;
}

/* Add what the step of log l from one edge to another of its family has, `factor` times its square. */
MESHONET_INLINE void bend_step(const Edge *one, const Edge *two, double factor, double bent, const Band *b)
{
    const ptrdiff_t node[4] = {one->from, one->to, two->from, two->to};
    const double x[4] = {one->x, -one->x, -two->x, two->x}, y[4] = {one->y, -one->y, -two->y, two->y};
    const double twice = 2.0 * factor, force = bent * twice * (two->length - one->length);
#pragma GCC unroll 4
    for (int p = 0; p < 4; p++)
#pragma GCC unroll 4
        for (int q = 0; q < 4; q++) {
            if (node[q] < 0 || node[p] < node[q])
                continue;
            double block[4] = {twice * x[p] * x[q], twice * x[p] * y[q], twice * y[p] * x[q], twice * y[p] * y[q]};
            if (p / 2 == q / 2) {
                const Edge *e = p < 2 ? one : two;
                const double f = (p == q) == (p >= 2) ? force : -force;
                block[0] += f * e->same, block[1] += f * e->cross, block[2] += f * e->cross, block[3] -= f * e->same;
            }
            add_block(b, node[p], node[q], block);
        }
}

/* Fill the band at the planes x, y (mi + 2, mj + 2) of a valid grid, times `unit`, an area. */
MESHONET_CLONES
void hessian(const double *x, const double *y, const Weights *weights, double unit, double bent, const Band *b)
{
    const ptrdiff_t ni = b->mi + 2, nj = b->mj + 2;
    const double cells = (double)(ni - 1) * (double)(nj - 1) / unit;
    const double one = 1.0 / (12.0 * cells), two = 8.0 * one, rest = 0.5 * (1.0 - weights->shape);
    const double along = rest * weights->aspect, across = rest / weights->aspect;
    const Factors at_corner = {one * along, one * across, one * weights->shape, 0.0};
    const Factors at_centre = {two * along, two * across, two * weights->shape, 0.0};
    memset(b->column, 0, (size_t)(2 * b->mi * b->mj * b->stride) * sizeof(float));
    for (ptrdiff_t i = 0; i < ni - 1; i++)
        for (ptrdiff_t j = 0; j < nj - 1; j++)
            bend_cell(x, y, nj, i, j, &at_corner, &at_centre, bent, b);
    if (!(weights->smoothness > 0.0))
        return;
    const double by_i = weights->smoothness / cells * (double)((ni - 1) * (ni - 1));
    const double by_j = weights->smoothness / cells * (double)((nj - 1) * (nj - 1));
    for (int family = 0; family < 2; family++) {
        const int along_i = family == 0;
        const ptrdiff_t rows = along_i ? ni - 1 : ni, columns = along_i ? nj : nj - 1;
        for (ptrdiff_t i = 0; i < rows; i++)
            for (ptrdiff_t j = 0; j < columns; j++) {
                const double on_i = along_i && (j == 0 || j == columns - 1) ? 0.5 : 1.0;
                const double on_j = !along_i && (i == 0 || i == rows - 1) ? 0.5 : 1.0;
                const Edge here = edge_at(x, y, nj, i, j, along_i, b);
                if (i + 1 < rows) {
                    const Edge east = edge_at(x, y, nj, i + 1, j, along_i, b);
                    bend_step(&here, &east, on_i * by_i, bent, b);
                }
                if (j + 1 < columns) {
                    const Edge north = edge_at(x, y, nj, i, j + 1, along_i, b);
                    bend_step(&here, &north, on_j * by_j, bent, b);
                }
            }
    }
}

/* One column of the factor; those before it in its panel of `done` are taken off first. Return 0 when H is not
   positive. */
MESHONET_INLINE int factorise_column(float *column, ptrdiff_t stride, ptrdiff_t width, int done)
{
    for (int q = 1; q <= done; q++) {
        const float *restrict before = column - q * stride + q;
        const float factor = before[0];
        MESHONET_INDEPENDENT
        for (ptrdiff_t l = 0; l <= width - q; l++)
            column[l] -= factor * before[l];
    }
    if (!(column[0] > 0.0f))
        return 0;
    const float root = sqrtf(column[0]), inverse = 1.0f / root;
    column[0] = root;
    for (ptrdiff_t l = 1; l <= width; l++)
        column[l] *= inverse;
    return 1;
}

/* L of H = L Lᵀ, in place, TOGETHER columns at a time; return 0 when H is not positive. Columns go on with zeros beyond
   the width and the last row, so that those of a panel are as long as each other and whole vectors. */
MESHONET_CLONES
int factorise(const Band *b)
{
    const ptrdiff_t n = 2 * b->mi * b->mj, width = b->width, stride = b->stride;
    for (ptrdiff_t c = 0; c < n; c += TOGETHER) {
        float *first = b->column + c * stride;
        const int count = n - c < TOGETHER ? (int)(n - c) : TOGETHER;
        for (int q = 0; q < count; q++)
            if (!factorise_column(first + q * stride, stride, width, q))
                return 0;
        const ptrdiff_t last = n - 1 - c < width + TOGETHER - 1 ? n - 1 - c : width + TOGETHER - 1;
        for (ptrdiff_t t = TOGETHER; t <= last; t++) {
            const float *restrict one = first + t, *restrict two = one + stride - 1;
            const float *restrict three = two + stride - 1, *restrict four = three + stride - 1;
            const float by_one = one[0], by_two = two[0], by_three = three[0], by_four = four[0];
            float *restrict to = first + t * stride;
            for (ptrdiff_t l = 0; l < width + TOGETHER - t; l += LANES)
                *(Lanes *)(to + l) -= (by_one * *(const Lanes *)(one + l) + by_two * *(const Lanes *)(two + l)) +
                                      (by_three * *(const Lanes *)(three + l) + by_four * *(const Lanes *)(four + l));
        }
    }
    return 1;
}

/* Replace r, with room for `width` zeros behind it, by H⁻¹ r. */
MESHONET_CLONES
void solve_band(const Band *b, float *restrict r)
{
    const ptrdiff_t n = 2 * b->mi * b->mj, width = b->width;
    memset(r + n, 0, (size_t)width * sizeof *r);
    for (ptrdiff_t c = 0; c < n; c++) {
        const float *restrict column = b->column + c * b->stride;
        const float value = r[c] /= column[0];
        for (ptrdiff_t l = 1; l <= width; l++)
            r[c + l] -= value * column[l];
    }
    for (ptrdiff_t c = n - 1; c >= 0; c--) {
        const float *restrict column = b->column + c * b->stride;
        r[c] = (r[c] - product_of_floats(column + 1, r + c + 1, width)) / column[0];
    }
}
