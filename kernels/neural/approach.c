/* The arithmetic of solvers/neural/quad/picard.py on one grid at a time, all of which stays in the caches. */
#include "approach.h"
#include "clones.h"
#include <math.h>
#include <string.h>
#include "waves.h"

#define BEFORE 7 /* numbers before a row of nodes, so that the unknown ones begin with a line of the cache */

static const double TINY = 1e-30;

/* Where things lie in scratch. */
typedef struct {
    ptrdiff_t pitch, plane, width, field;
    double *z;              /* nodes (2, rows, pitch), `plane` apart; `around`, two more rows at either end */
    double *waves, *other; /* what is missed, transformed: (2, rows, width), `field` apart, and room for one */
    double *step, *move;    /* the last ones, transformed, when steps are extrapolated */
    double *room;           /* for a row at work */
} Places;

MESHONET_INLINE Places sizes(const Approach *a)
{
    Places p = {0};
    p.width = a->eta.line, p.field = a->xi.count * p.width;
    p.pitch = (a->n + 2 * LANES - 2) / LANES * LANES, p.plane = (a->xi.count + 4) * p.pitch;
    return p;
}

MESHONET_INLINE Places places(const Approach *a, double *scratch)
{
    Places p = sizes(a);
    p.waves = scratch, p.other = p.waves + 2 * p.field;
    p.step = p.other + p.field, p.move = p.step + 2 * p.field, p.room = p.move + 2 * p.field;
    p.z = p.room + 10 * p.pitch + BEFORE;
    return p;
}

ptrdiff_t approach_scratch(const Approach *a)
{
    const Places p = sizes(a);
    return 7 * p.field + 10 * p.pitch + 2 * p.plane + 2 * LANES;
}

/* Weights of five nodes in a row in the first and the second difference at one of them, 1, 2 or 3. */
typedef struct {
    double slope[5], bend[5];
} Stencil;

MESHONET_INLINE Stencil stencil(int node, double share)
{
    static const double third[5] = {-0.5, 1.0, 0.0, -1.0, 0.5}, fourth[5] = {1.0, -4.0, 6.0, -4.0, 1.0};
    Stencil s;
    for (int k = 0; k < 5; k++) {
        s.slope[k] = -share / 6.0 * third[k];
        s.bend[k] = -share / 12.0 * fourth[k];
    }
    s.slope[node - 1] -= 0.5, s.slope[node + 1] += 0.5;
    s.bend[node - 1] += 1.0, s.bend[node] -= 2.0, s.bend[node + 1] += 1.0;
    return s;
}

/* Differences of five values, `by` apart. */
#define WEIGHED(load, z, by, c) \
    (load((z)) * (c)[0] + load((z) + (by)) * (c)[1] + load((z) + 2 * (by)) * (c)[2] + load((z) + 3 * (by)) * (c)[3] + \
     load((z) + 4 * (by)) * (c)[4])
#define ONE(pointer) (*(pointer))

/* What a row of a plane needs: first and second differences along xi and eta, and along both, at its nodes 1, 2, ... */
typedef struct {
    double *u, *v, *uu, *vv, *uv;
} Row;

/* z points to the row, whose place among five along xi tells `at`; s are those of nodes 1, 2 and 3. */
MESHONET_INLINE void differ(const double *restrict z, ptrdiff_t pitch, ptrdiff_t n, const Stencil *s, int at,
                            const Row *row)
{
    double *restrict u = row->u, *restrict uu = row->uu, *restrict v = row->v, *restrict vv = row->vv;
    double *restrict uv = row->uv;
    const double *first = z - (at + 1) * pitch;
    const Stencil down = s[at], along = s[1];
    AT(u - BEFORE) = WEIGHED(OF, first - BEFORE, pitch, down.slope);
    for (ptrdiff_t j = 1; j < n; j += LANES) {
        AT(u + j) = WEIGHED(OF, first + j, pitch, down.slope);
        AT(uu + j) = WEIGHED(OF, first + j, pitch, down.bend);
        AT(v + j) = WEIGHED(OF, z + j - 2, 1, along.slope);
        AT(vv + j) = WEIGHED(OF, z + j - 2, 1, along.bend);
    }
    for (ptrdiff_t j = 1; j < n; j += LANES)
        AT(uv + j) = WEIGHED(OF, u + j - 2, 1, along.slope);
    for (int end = 0; end < 3; end += 2) {
        const ptrdiff_t j = end ? n - 2 : 1, begin = end ? n - 5 : 0;
        v[j] = WEIGHED(ONE, z + begin, 1, s[end].slope);
        vv[j] = WEIGHED(ONE, z + begin, 1, s[end].bend);
        uv[j] = WEIGHED(ONE, u + begin, 1, s[end].slope);
    }
}

/* By how much a row misses Winslow's equations with the coefficients of its differences x and y, into x->u and y->u;
   shares of the coefficients are added to sums. */
MESHONET_INLINE void winslow_row(const Row *x, const Row *y, ptrdiff_t n, Lanes *sums)
{
    for (ptrdiff_t j = n - 1; j % LANES != 1; j++) /* what is not off the rim does not count */
        x->u[j] = y->u[j] = x->v[j] = y->v[j] = 0.0;
    for (ptrdiff_t j = 1; j < n - 1; j += LANES) {
        const Lanes ux = OF(x->u + j), uy = OF(y->u + j), vx = OF(x->v + j), vy = OF(y->v + j);
        const Lanes alpha = vx * vx + vy * vy, gamma = ux * ux + uy * uy, one = 1.0 / (alpha + gamma + TINY);
        const Lanes first = alpha * one, second = gamma * one, mixed = (ux * vx + uy * vy) * one * -2.0;
        AT(x->u + j) = first * OF(x->uu + j) + mixed * OF(x->uv + j) + second * OF(x->vv + j);
        AT(y->u + j) = first * OF(y->uu + j) + mixed * OF(y->uv + j) + second * OF(y->vv + j);
        sums[0] += first, sums[1] += second;
    }
}

/* By how much it misses Laplace's equations along xi and eta, to `out`. */
MESHONET_INLINE void laplace_row(const double *z, ptrdiff_t pitch, ptrdiff_t n, double *out)
{
    for (ptrdiff_t j = 1; j < n - 1; j += LANES)
        AT(out + j) = OF(z + j - pitch) + OF(z + j + pitch) + OF(z + j - 1) + OF(z + j + 1) - 4.0 * OF(z + j);
}

/* By how much the nodes miss the equations, into `waves`, and the means of their coefficients. */
MESHONET_INLINE void find_missed(const Approach *a, const Places *p, int linear, double *restrict mean)
{
    const ptrdiff_t n = a->n, rows = a->xi.count, top = a->around ? 2 : 1;
    const Stencil s[3] = {stencil(1, a->share), stencil(2, a->share), stencil(3, a->share)};
    Row row[2];
    for (int q = 0; q < 2; q++) {
        double *room = p->room + 5 * q * p->pitch + BEFORE;
        row[q] = (Row){room, room + p->pitch, room + 2 * p->pitch, room + 3 * p->pitch, room + 4 * p->pitch};
    }
    Lanes sums[2] = {{0}};
    for (ptrdiff_t i = 0; i < rows; i++) {
        const int at = a->around ? 1 : i == 0 ? 0 : i == rows - 1 ? 2 : 1;
        for (int q = 0; q < 2; q++) {
            const double *z = p->z + q * p->plane + (top + i) * p->pitch;
            if (linear)
                laplace_row(z, p->pitch, n, row[q].u);
            else
                differ(z, p->pitch, n, s, at, &row[q]);
        }
        if (!linear)
            winslow_row(&row[0], &row[1], n, sums);
        for (int q = 0; q < 2; q++)
            memcpy(p->waves + q * p->field + i * p->width, row[q].u + 1, (size_t)(n - 2) * sizeof(double));
    }
    for (int k = 0; k < 2; k++)
        mean[k] = linear ? 1.0 : summed(sums[k]) / (double)(rows * (n - 2));
}

/* What is missed over the operator with the mean coefficients, transformed; returns the mean of its squares. */
MESHONET_INLINE double solve(const Approach *a, const Places *p, const double *mean)
{
    const Waves *xi = &a->xi, *eta = &a->eta;
    Lanes squares = {0};
    for (int q = 0; q < 2; q++) {
        along_rows(eta, p->waves + q * p->field, xi->count, p->other);
        along_columns(xi, p->other, p->width, p->waves + q * p->field);
    }
    for (ptrdiff_t i = 0; i < xi->count; i++)
        for (ptrdiff_t c = 0; c < p->width; c += LANES) {
            const Lanes one = 1.0 / (mean[0] * xi->values[i] + mean[1] * OF(eta->values + c));
            for (int q = 0; q < 2; q++) {
                double *wave = p->waves + q * p->field + i * p->width + c;
                const Lanes value = OF(wave) * one;
                AT(wave) = value;
                squares += value * value;
            }
        }
    return summed(squares) / (double)(2 * xi->count * (a->n - 2));
}

/* Replace the step by that to where it vanishes when it is linear along the last move: f - g (f - f' + move), with f'
   the last step and g = (f - f').f / |f - f'|^2, 1 at the most. Transforms keep products. */
MESHONET_INLINE void extrapolate(const Places *p, int first)
{
    Lanes along = {0}, squares = {0};
    for (ptrdiff_t k = 0; k < 2 * p->field && !first; k += LANES) {
        const Lanes f = OF(p->waves + k), change = f - OF(p->step + k);
        along += change * f, squares += change * change;
    }
    const double share = summed(along) / (summed(squares) + TINY), g = share < -1.0 ? -1.0 : share > 1.0 ? 1.0 : share;
    for (ptrdiff_t k = 0; k < 2 * p->field; k += LANES) {
        const Lanes f = OF(p->waves + k), change = f - OF(p->step + k);
        Lanes move = f;
        if (!first)
            move -= g * (change + OF(p->move + k));
        AT(p->step + k) = f, AT(p->waves + k) = AT(p->move + k) = move;
    }
}

/* Transform back, in place. */
MESHONET_INLINE void transform_back(const Approach *a, const Places *p)
{
    for (int q = 0; q < 2; q++) {
        along_columns(&a->xi, p->waves + q * p->field, p->width, p->other);
        along_rows(&a->eta, p->other, a->xi.count, p->waves + q * p->field);
    }
}

/* Rows beyond the ends of planes that go round, a turn before and after. */
MESHONET_INLINE void go_round(const Approach *a, const Places *p, const double *turn)
{
    const ptrdiff_t rows = a->xi.count;
    for (int q = 0; q < 2; q++, turn += a->n)
        for (int i = 0; i < 2; i++) {
            double *before = p->z + q * p->plane + i * p->pitch, *after = before + (rows + 2) * p->pitch;
            for (ptrdiff_t j = 0; j < a->n; j++) {
                before[j] = before[rows * p->pitch + j] - turn[j];
                after[j] = after[-rows * p->pitch + j] + turn[j];
            }
        }
}

/* Add what `waves` holds by now to the rows of planes z, `plane` apart, from the first unknown one on. */
MESHONET_INLINE void add(const Approach *a, const Places *p, double *z, ptrdiff_t pitch, ptrdiff_t plane)
{
    for (int q = 0; q < 2; q++)
        for (ptrdiff_t i = 0; i < a->xi.count; i++) {
            const double *from = p->waves + q * p->field + i * p->width;
            double *row = z + q * plane + i * pitch + 1;
            for (ptrdiff_t j = 0; j < a->n - 2; j++)
                row[j] += from[j];
        }
}

MESHONET_CLONES
void approach_grid(const Approach *a, double *nodes, const double *turn, double *scratch, double *step)
{
    const Places p = places(a, scratch);
    const ptrdiff_t n = a->n, rows = a->around ? a->m - 1 : a->m, first = a->around ? 2 : 0;
    double size = INFINITY, mean[2];
    memset(step, 0, (size_t)(2 * a->m * n) * sizeof(double));
    for (int q = 0; q < 2; q++)
        for (ptrdiff_t i = 0; i < rows; i++)
            memcpy(p.z + q * p.plane + (first + i) * p.pitch, nodes + (q * a->m + i) * n, (size_t)n * sizeof(double));
    for (int k = a->harmonic ? 0 : 1; k <= a->steps; k++) {
        if (a->around)
            go_round(a, &p, turn);
        find_missed(a, &p, k == 0, mean);
        const double square = solve(a, &p, mean);
        if (!(square < a->growth * size)) /* or not a number */
            continue;
        size = square;
        if (!a->harmonic)
            extrapolate(&p, k == 1);
        transform_back(a, &p);
        add(a, &p, p.z + (a->around ? 2 : 1) * p.pitch, p.pitch, p.plane);
        if (k == a->steps && !a->harmonic) {
            memcpy(p.waves, p.step, (size_t)(2 * p.field) * sizeof(double));
            transform_back(a, &p);
        }
        if (k == a->steps)
            add(a, &p, step + (a->around ? 0 : n), n, a->m * n);
    }
    for (int q = 0; q < 2; q++) {
        for (ptrdiff_t i = 0; i < rows; i++)
            memcpy(nodes + (q * a->m + i) * n, p.z + q * p.plane + (first + i) * p.pitch, (size_t)n * sizeof(double));
        for (ptrdiff_t j = 0; j < n && a->around; j++) {
            nodes[(q * a->m + rows) * n + j] = nodes[q * a->m * n + j] + turn[q * n + j];
            step[(q * a->m + rows) * n + j] = step[q * a->m * n + j];
        }
    }
}
