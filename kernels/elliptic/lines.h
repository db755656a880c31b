/* Zebra line relaxation along eta and along xi, both colours in one pass: a group of lines of the second colour
   follows the adjacent lines of the first. A thread's first line of the second colour waits for the thread before. */
#pragma once
#include "stencil.h"
#include "team.h"
#include <string.h>

enum { LANES = 8, BLOCK = 64, AHEAD = 8 }; /* lines along eta, lines along xi that advance together; rows */

/* ---- eta lines: i fixed, unknowns along j; neighbouring lines of one colour are independent ---- */

typedef struct {
    double *lower, *upper, *diagonal, *bx, *by; /* LANES rows of `stride` each */
    double *phi, *psi; /* of the line at work */
    ptrdiff_t stride;
} EtaSystem;

MESHONET_INLINE void eta_assemble_with(const Level *g, ptrdiff_t i, const EtaSystem *s, int k, int mode)
{
    const Rows r = rows_at(g, i);
    const double forward = g->xi.forward[i], backward = g->xi.backward[i], centred = g->xi.centred[i];
    const Differences eta = g->eta;
    const ptrdiff_t mj = g->mj;
    double *restrict lower = s->lower + k * s->stride, *restrict upper = s->upper + k * s->stride;
    double *restrict diagonal = s->diagonal + k * s->stride;
    double *restrict bx = s->bx + k * s->stride, *restrict by = s->by + k * s->stride;
    const int forced = mode & FORCED;
    const double *restrict fx = forced ? g->fx + i * (mj + 1) : 0, *restrict fy = forced ? g->fy + i * (mj + 1) : 0;
    const double *restrict phi = s->phi, *restrict psi = s->psi;
    if (mode & CONTROLLED)
        control_row(g, i, 0, 1, mj, s->phi, s->psi);
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 1; j < mj; j++) {
        const Stencil c = stencil(&r, j, forward, backward, centred, &eta, mode & CONTROLLED ? phi[j] : 0.0,
                                  mode & CONTROLLED ? psi[j] : 0.0, mode);
        lower[j] = c.south;
        upper[j] = c.north;
        diagonal[j] = -(c.east + c.west + c.north + c.south);
        bx[j] = c.cross_x - c.east * r.xe[j] - c.west * r.xw[j] + (forced ? fx[j] : 0.0);
        by[j] = c.cross_y - c.east * r.ye[j] - c.west * r.yw[j] + (forced ? fy[j] : 0.0);
    }
    upper[0] = 0.0, bx[0] = r.xc[0], by[0] = r.yc[0];
}

/* Assemble the tridiagonal system of eta line i in lane k. */
MESHONET_CLONES
static void eta_assemble(const Level *g, ptrdiff_t i, const EtaSystem *s, int k, int mode)
{
    BY_MODE(mode, eta_assemble_with, g, i, s, k);
}

/* Solve `lanes` systems side by side (their recurrences overlap) and write lines i, i + 2, ... */
MESHONET_INLINE void eta_solve_with(const Level *g, ptrdiff_t i, const EtaSystem *s, int lanes)
{
    const ptrdiff_t ld = g->mj + 1, mj = g->mj, st = s->stride;
    double up[LANES], px[LANES], py[LANES];
    for (int k = 0; k < lanes; k++)
        up[k] = 0.0, px[k] = s->bx[k * st], py[k] = s->by[k * st];
    for (ptrdiff_t j = 1; j < mj; j++)
        for (int k = 0; k < lanes; k++) {
            const ptrdiff_t q = k * st + j;
            const double low = s->lower[q], w = 1.0 / (s->diagonal[q] - low * up[k]);
            s->upper[q] = up[k] = s->upper[q] * w;
            s->bx[q] = px[k] = (s->bx[q] - low * px[k]) * w;
            s->by[q] = py[k] = (s->by[q] - low * py[k]) * w;
        }
    double *x = g->x + i * ld, *y = g->y + i * ld;
    for (int k = 0; k < lanes; k++)
        px[k] = x[2 * k * ld + mj], py[k] = y[2 * k * ld + mj];
    for (ptrdiff_t j = mj - 1; j > 0; j--)
        for (int k = 0; k < lanes; k++) {
            const ptrdiff_t q = k * st + j;
            x[2 * k * ld + j] = px[k] = s->bx[q] - s->upper[q] * px[k];
            y[2 * k * ld + j] = py[k] = s->by[q] - s->upper[q] * py[k];
        }
}

MESHONET_CLONES
static void eta_solve(const Level *g, ptrdiff_t i, const EtaSystem *s, int lanes)
{
    if (lanes == LANES)
        eta_solve_with(g, i, s, LANES);
    else
        eta_solve_with(g, i, s, lanes);
}

/* Relax the `lines` (LANES at the most) eta lines i, i + 2, ... */
static void eta_group(const Level *g, ptrdiff_t i, ptrdiff_t lines, int forced)
{
    const ptrdiff_t stride = padded(g->mj);
    double *b = g->scratch;
    double *control = b + 5 * LANES * stride;
    const EtaSystem s = {b, b + LANES * stride, b + 2 * LANES * stride, b + 3 * LANES * stride, b + 4 * LANES * stride,
                         control, control + stride, stride};
    for (int k = 0; k < lines; k++)
        eta_assemble(g, i + 2 * k, &s, k, mode_of(g, forced));
    eta_solve(g, i, &s, (int)lines);
}

static void close_ring(const Level *g)
{
    const ptrdiff_t last = g->mi * (g->mj + 1);
    memcpy(g->x + last, g->x, (size_t)(g->mj + 1) * sizeof(double));
    memcpy(g->y + last, g->y, (size_t)(g->mj + 1) * sizeof(double));
}

/* How many of k, k + 2, ... lie below `end`, `most` at the most. */
static ptrdiff_t every_second(ptrdiff_t k, ptrdiff_t end, ptrdiff_t most)
{
    const ptrdiff_t n = k < end ? (end - k + 1) / 2 : 0;
    return n < most ? n : most;
}

static ptrdiff_t eta_start(const Level *g)
{
    return g->periodic ? 0 : 1;
}

/* Group k of the first colour, and those of the second whose neighbours are done with it. */
static void eta_first(const Level *g, ptrdiff_t k, int forced)
{
    const ptrdiff_t i = eta_start(g) + 2 * LANES * k;
    eta_group(g, i, every_second(i, g->mi, LANES), forced);
    if (g->periodic && i == 0)
        close_ring(g);
}

static void eta_second(const Level *g, ptrdiff_t k, int forced)
{
    const ptrdiff_t first = eta_start(g), i = first + 2 * LANES * k, behind = i > first ? i - 1 : first + 1;
    const ptrdiff_t ready = i + 2 * LANES - 2; /* later lines wait for the next group, unless there is none */
    eta_group(g, behind, every_second(behind, ready < g->mi ? ready : g->mi, LANES), forced);
}

/* ---- xi lines: j fixed, unknowns along i; a block of lines of one colour advances together ---- */

/* One tridiagonal row of each line of the block. */
typedef struct {
    double lower, upper, diagonal, bx, by;
} XiRow;

MESHONET_INLINE XiRow xi_row(const Level *g, const Rows *r, ptrdiff_t i, ptrdiff_t j, double phi, double psi, int mode)
{
    const Stencil c = stencil(r, j, g->xi.forward[i], g->xi.backward[i], g->xi.centred[i], &g->eta, phi, psi, mode);
    XiRow t;
    t.lower = c.west;
    t.upper = c.east;
    t.diagonal = -(c.east + c.west + c.north + c.south);
    t.bx = c.cross_x - c.north * r->xc[j + 1] - c.south * r->xc[j - 1];
    t.by = c.cross_y - c.north * r->yc[j + 1] - c.south * r->yc[j - 1];
    if (mode & FORCED) {
        t.bx += g->fx[i * (g->mj + 1) + j];
        t.by += g->fy[i * (g->mj + 1) + j];
    }
    return t;
}

/* Ask for row i of the nodes of a block before it is needed: it is on a page of its own, and the processor cannot know
   which comes next. */
MESHONET_INLINE void expect_row(const Level *g, ptrdiff_t i, ptrdiff_t j0, int n)
{
#if defined(__GNUC__)
    if (i < 0 || i > g->mi)
        return;
    const double *x = g->x + i * (g->mj + 1) + j0, *y = g->y + i * (g->mj + 1) + j0;
    for (int k = 0; k < 2 * n; k += 8) {
        __builtin_prefetch(x + k);
        __builtin_prefetch(y + k);
    }
#endif
}

/* Lines j0, j0 + 2, ... (n of them) between rows 0 and mi. Periodic ones: with X_0 = 0 one solution q of rows 1 .. mi-1
   meets the right side and another, p, has X_0 = 1 and no right side; row 0 then says which X = q + X_0 p is the line. */
MESHONET_INLINE void xi_block(const Level *g, ptrdiff_t j0, int n, const int periodic, const int mode)
{
    double phi[BLOCK], psi[BLOCK], ex[BLOCK], ey[BLOCK];
    const ptrdiff_t mi = g->mi, ld = g->mj + 1, last = (mi - 1) * BLOCK;
    double *up = g->scratch, *qx = up + BLOCK * (mi + 1), *qy = qx + BLOCK * (mi + 1), *p = qy + BLOCK * (mi + 1);
    XiRow closing[BLOCK];
    if (periodic) {
        const Rows r = rows_at(g, 0);
        if (mode & CONTROLLED)
            control_row(g, 0, j0, 2, n, phi, psi);
        for (int k = 0; k < n; k++) {
            closing[k] = xi_row(g, &r, 0, j0 + 2 * k, mode & CONTROLLED ? phi[k] : 0.0,
                                mode & CONTROLLED ? psi[k] : 0.0, mode);
            p[k] = p[mi * BLOCK + k] = 1.0, qx[mi * BLOCK + k] = qy[mi * BLOCK + k] = 0.0;
        }
    }
    for (int k = 0; k < n; k++)
        up[k] = 0.0, qx[k] = periodic ? 0.0 : g->x[j0 + 2 * k], qy[k] = periodic ? 0.0 : g->y[j0 + 2 * k];
    for (ptrdiff_t i = 1; i < mi; i++) {
        const Rows r = rows_at(g, i);
        double *restrict u = up + i * BLOCK, *restrict bx = qx + i * BLOCK, *restrict by = qy + i * BLOCK;
        double *restrict bp = p + i * BLOCK;
        const double *restrict u1 = u - BLOCK, *restrict bx1 = bx - BLOCK, *restrict by1 = by - BLOCK;
        const double *restrict bp1 = bp - BLOCK;
        expect_row(g, i + AHEAD, j0, n);
        if (mode & CONTROLLED)
            control_row(g, i, j0, 2, n, phi, psi);
        MESHONET_INDEPENDENT
        for (int k = 0; k < n; k++) {
            const XiRow t = xi_row(g, &r, i, j0 + 2 * k, mode & CONTROLLED ? phi[k] : 0.0,
                                   mode & CONTROLLED ? psi[k] : 0.0, mode);
            const double w = 1.0 / (t.diagonal - t.lower * u1[k]);
            u[k] = t.upper * w;
            bx[k] = (t.bx - t.lower * bx1[k]) * w;
            by[k] = (t.by - t.lower * by1[k]) * w;
            if (periodic)
                bp[k] = -t.lower * bp1[k] * w;
        }
    }
    for (int k = 0; k < n && !periodic; k++)
        ex[k] = g->x[mi * ld + j0 + 2 * k], ey[k] = g->y[mi * ld + j0 + 2 * k];
    for (ptrdiff_t i = mi - 1; i > 0; i--) {
        const double *restrict u = up + i * BLOCK;
        double *restrict bx = qx + i * BLOCK, *restrict by = qy + i * BLOCK, *restrict bp = p + i * BLOCK;
        double *restrict x = g->x + i * ld + j0, *restrict y = g->y + i * ld + j0;
        if (periodic) {
            for (int k = 0; k < n; k++) {
                bx[k] -= u[k] * bx[k + BLOCK];
                by[k] -= u[k] * by[k + BLOCK];
                bp[k] -= u[k] * bp[k + BLOCK];
            }
            continue;
        }
        expect_row(g, i - AHEAD, j0, n);
        for (int k = 0; k < n; k++) {
            x[2 * k] = ex[k] = bx[k] - u[k] * ex[k];
            y[2 * k] = ey[k] = by[k] - u[k] * ey[k];
        }
    }
    if (!periodic)
        return;
    for (int k = 0; k < n; k++) {
        const XiRow t = closing[k];
        const double w = 1.0 / (t.diagonal + t.lower * p[last + k] + t.upper * p[BLOCK + k]);
        ex[k] = (t.bx - t.lower * qx[last + k] - t.upper * qx[BLOCK + k]) * w;
        ey[k] = (t.by - t.lower * qy[last + k] - t.upper * qy[BLOCK + k]) * w;
        g->x[j0 + 2 * k] = g->x[mi * ld + j0 + 2 * k] = ex[k];
        g->y[j0 + 2 * k] = g->y[mi * ld + j0 + 2 * k] = ey[k];
    }
    for (ptrdiff_t i = 1; i < mi; i++) {
        expect_row(g, i + AHEAD, j0, n);
        const double *restrict bx = qx + i * BLOCK, *restrict by = qy + i * BLOCK, *restrict bp = p + i * BLOCK;
        double *restrict x = g->x + i * ld + j0, *restrict y = g->y + i * ld + j0;
        for (int k = 0; k < n; k++) {
            x[2 * k] = bx[k] + ex[k] * bp[k];
            y[2 * k] = by[k] + ey[k] * bp[k];
        }
    }
}

MESHONET_CLONES
static void xi_group(const Level *g, ptrdiff_t j0, ptrdiff_t lines, int forced)
{
    const int n = (int)lines, mode = mode_of(g, forced);
    if (g->periodic)
        BY_MODE(mode, xi_block, g, j0, n, 1);
    else
        BY_MODE(mode, xi_block, g, j0, n, 0);
}

static void xi_first(const Level *g, ptrdiff_t k, int forced)
{
    const ptrdiff_t j = 1 + 2 * BLOCK * k;
    xi_group(g, j, every_second(j, g->mj, BLOCK), forced);
}

static void xi_second(const Level *g, ptrdiff_t k, int forced)
{
    const ptrdiff_t j = 1 + 2 * BLOCK * k, behind = j > 1 ? j - 1 : 2, ready = j + 2 * BLOCK - 2;
    xi_group(g, behind, every_second(behind, ready < g->mj ? ready : g->mj, BLOCK), forced);
}

/* ---- groups of both colours, in the order of one thread ---- */

typedef void (*Colour)(const Level *g, ptrdiff_t k, int forced);

/* In a ring the first group is done before any other begins. */
static void zebra(const Level *g, Member member, ptrdiff_t groups, Colour first, Colour second, int ring, int forced)
{
    const Range own = team_share(groups, member);
    if (own.first == 0 && own.first < own.last)
        first(g, own.first, forced);
    if (ring)
        team_wait(member);
    for (ptrdiff_t k = own.first; k < own.last; k++) {
        if (k > 0)
            first(g, k, forced);
        if (k > own.first || own.first == 0)
            second(g, k, forced);
    }
    team_wait(member);
    if (own.first > 0 && own.first < own.last)
        second(g, own.first, forced);
    team_wait(member);
}

/* Of a ring lines 0 and mi are one, and the last line looks at it. */
static void eta_lines(const Level *g, Member member, int forced)
{
    const ptrdiff_t groups = (g->mi - eta_start(g)) / (2 * LANES) + 1;
    zebra(g, member, groups, eta_first, eta_second, g->periodic, forced);
}

static void xi_lines(const Level *g, Member member, int forced)
{
    zebra(g, member, (g->mj - 1) / (2 * BLOCK) + 1, xi_first, xi_second, 0, forced);
}
