/* The arithmetic of approach.py on one grid at a time, all of which stays in the caches. */
#include "approach_kernel.h"
#include "clones.h"
#include <math.h>
#include <string.h>

#define BLOCK 4 /* rows of a product that are made together */

static const double TINY = 1e-30;

typedef double Lanes __attribute__((vector_size(8 * sizeof(double)), aligned(8)));

ptrdiff_t approach_scratch(const Approach *a)
{
    return 2 * (a->m + 4) * a->n + 6 * a->rows * a->width + 10 * a->n;
}

/* `count` rows of out = those of a (., inner) times b (inner, width). */
MESHONET_INLINE void some_rows(const double *a, ptrdiff_t inner, ptrdiff_t line, const double *b, ptrdiff_t width,
                               double *out, const int count)
{
    for (ptrdiff_t c = 0; c < width; c += APPROACH_WIDTH) {
        Lanes sum[BLOCK][2] = {{{0}}};
        for (ptrdiff_t k = 0; k < inner; k++) {
            const Lanes low = *(const Lanes *)(b + k * width + c), high = *(const Lanes *)(b + k * width + c + 8);
#pragma GCC unroll 4
            for (int r = 0; r < count; r++) {
                sum[r][0] += a[r * line + k] * low;
                sum[r][1] += a[r * line + k] * high;
            }
        }
        for (int r = 0; r < count; r++) {
            *(Lanes *)(out + r * width + c) = sum[r][0];
            *(Lanes *)(out + r * width + c + 8) = sum[r][1];
        }
    }
}

/* out (rows, width) = a (rows, inner), rows `line` apart, times b (inner, width). */
MESHONET_INLINE void product(const double *a, ptrdiff_t rows, ptrdiff_t inner, ptrdiff_t line, const double *b,
                             ptrdiff_t width, double *out)
{
    ptrdiff_t i = 0;
    for (; i + BLOCK <= rows; i += BLOCK)
        some_rows(a + i * line, inner, line, b, width, out + i * width, BLOCK);
    for (; i < rows; i++)
        some_rows(a + i * line, inner, line, b, width, out + i * width, 1);
}

/* Differences at a node whose neighbours are `by` apart: z points to it, e to the node whose error counts. */
MESHONET_INLINE double slope(const double *z, const double *e, ptrdiff_t by, double share)
{
    const double third = 0.5 * (e[2 * by] - e[-2 * by]) + e[-by] - e[by];
    return 0.5 * (z[by] - z[-by]) - share * third;
}

MESHONET_INLINE double bend(const double *z, const double *e, ptrdiff_t by, double share)
{
    const double fourth = e[2 * by] + e[-2 * by] - 4.0 * (e[by] + e[-by]) + 6.0 * e[0];
    return z[by] + z[-by] - 2.0 * z[0] - share * fourth;
}

/* Either of them along a row at its nodes but the ends. */
#define ALONG(difference, z, n, share, out) \
    do { \
        (out)[1] = difference((z) + 1, (z) + 2, 1, share); \
        for (ptrdiff_t j = 2; j < (n) - 2; j++) \
            (out)[j] = difference((z) + j, (z) + j, 1, share); \
        (out)[(n) - 2] = difference((z) + (n) - 2, (z) + (n) - 3, 1, share); \
    } while (0)

/* What a row of a grid needs: first and second differences along xi and eta, and along both. */
typedef struct {
    double *u, *v, *uu, *vv, *uv;
} Row;

/* z points to the row, e to that whose error along xi counts. */
MESHONET_INLINE void differ(const double *restrict z, const double *restrict e, ptrdiff_t n, double share, Row *row)
{
    double *restrict u = row->u, *restrict uu = row->uu, *restrict v = row->v, *restrict vv = row->vv;
    double *restrict uv = row->uv;
    for (ptrdiff_t j = 0; j < n; j++) {
        u[j] = slope(z + j, e + j, n, share / 6.0);
        uu[j] = bend(z + j, e + j, n, share / 12.0);
    }
    ALONG(slope, z, n, share / 6.0, v);
    ALONG(bend, z, n, share / 12.0, vv);
    ALONG(slope, u, n, share / 6.0, uv);
}

/* By how much the planes `ring`, `plane` numbers apart, miss the equations: missed (2, rows, width), and the means of
   their coefficients. Laplace's along xi and eta when `linear`. `room` holds 10 n numbers. */
MESHONET_INLINE void find_missed(const Approach *a, const double *ring, ptrdiff_t plane, int linear, double *room,
                                 double *restrict missed, double *restrict mean)
{
    const ptrdiff_t n = a->n, first = a->around ? 2 : 1, last = first + a->rows - 1, field = a->rows * a->width;
    Row x = {room, room + n, room + 2 * n, room + 3 * n, room + 4 * n}, y = x;
    y.u += 5 * n, y.v += 5 * n, y.uu += 5 * n, y.vv += 5 * n, y.uv += 5 * n;
    mean[0] = mean[1] = 0.0;
    for (ptrdiff_t i = first; i <= last; i++) {
        ptrdiff_t whose = i;
        if (!a->around)
            whose = i == first ? first + 1 : i == last ? last - 1 : i;
        const double share = linear ? 0.0 : a->share;
        differ(ring + i * n, ring + whose * n, n, share, &x);
        differ(ring + plane + i * n, ring + plane + whose * n, n, share, &y);
        double *restrict out = missed + (i - first) * a->width - 1;
        if (linear) {
            for (ptrdiff_t j = 1; j < n - 1; j++)
                out[j] = x.uu[j] + x.vv[j], out[j + field] = y.uu[j] + y.vv[j];
            continue;
        }
        for (ptrdiff_t j = 1; j < n - 1; j++) {
            const double alpha = x.v[j] * x.v[j] + y.v[j] * y.v[j], gamma = x.u[j] * x.u[j] + y.u[j] * y.u[j];
            const double beta = x.u[j] * x.v[j] + y.u[j] * y.v[j], one = 1.0 / (alpha + gamma + TINY);
            out[j] = (alpha * x.uu[j] - 2.0 * beta * x.uv[j] + gamma * x.vv[j]) * one;
            out[j + field] = (alpha * y.uu[j] - 2.0 * beta * y.uv[j] + gamma * y.vv[j]) * one;
            mean[0] += alpha * one, mean[1] += gamma * one;
        }
    }
    for (int k = 0; k < 2; k++)
        mean[k] = linear ? 1.0 : mean[k] / (double)(a->rows * (n - 2));
}

/* Fields (rows, width) over the operator with the mean coefficients, in place; `other` has room for as much. */
MESHONET_INLINE void invert(const Approach *a, const double *mean, double *field, double *other)
{
    product(a->left, a->rows, a->rows, a->rows, field, a->width, other);
    product(other, a->rows, a->n - 2, a->width, a->right, a->width, field);
    for (ptrdiff_t i = 0; i < a->rows; i++)
        for (ptrdiff_t j = 0; j < a->width; j++)
            field[i * a->width + j] /= mean[0] * a->slow[i] + mean[1] * a->fast[j];
    product(a->left, a->rows, a->rows, a->rows, field, a->width, other);
    product(other, a->rows, a->n - 2, a->width, a->right, a->width, field);
}

/* The planes with two rows more at either end, a turn before and after. */
MESHONET_INLINE void go_round(const Approach *a, const double *p, const double *turn, double *ring)
{
    const ptrdiff_t n = a->n, m = a->m - 1;
    for (int q = 0; q < 2; q++, p += a->m * n, ring += (m + 4) * n, turn += n) {
        memcpy(ring + 2 * n, p, (size_t)(m * n) * sizeof(double));
        for (ptrdiff_t j = 0; j < 2 * n; j++) {
            ring[j] = p[(m - 2) * n + j] - turn[j % n];
            ring[(m + 2) * n + j] = p[j] + turn[j % n];
        }
    }
}

/* Replace the step in `missed` by that to where it vanishes when it is linear along the last move: f - g (f - f' + move),
   with f' the last step and g = (f - f')·f / |f - f'|², 1 at the most. `move` holds the last move, then this one. */
MESHONET_INLINE void extrapolate(const Approach *a, double *missed, const double *step, double *move, int first)
{
    const ptrdiff_t n = a->n, plane = a->m * n, field = a->rows * a->width, top = a->around ? 0 : 1;
    double along = 0.0, squares = TINY;
    for (int q = 0; q < 2 && !first; q++)
        for (ptrdiff_t i = 0; i < a->rows; i++) {
            const double *f = missed + q * field + i * a->width, *before = step + q * plane + (top + i) * n + 1;
            for (ptrdiff_t j = 0; j < n - 2; j++)
                along += (f[j] - before[j]) * f[j], squares += (f[j] - before[j]) * (f[j] - before[j]);
        }
    const double share = along / squares, g = share < -1.0 ? -1.0 : share > 1.0 ? 1.0 : share;
    for (int q = 0; q < 2; q++)
        for (ptrdiff_t i = 0; i < a->rows; i++) {
            const double *f = missed + q * field + i * a->width, *before = step + q * plane + (top + i) * n + 1;
            double *to = move + q * field + i * a->width;
            for (ptrdiff_t j = 0; j < n - 2; j++)
                to[j] = first ? f[j] : f[j] - g * (f[j] - before[j] + to[j]);
        }
}

MESHONET_CLONES
void approach_grid(const Approach *a, double *p, const double *turn, double *scratch, double *step)
{
    const ptrdiff_t n = a->n, plane = a->m * n, field = a->rows * a->width, top = a->around ? 0 : 1;
    double *missed = scratch, *move = missed + 2 * field, *other = move + 2 * field, *room = other + field;
    double *ring = room + 10 * n, *by = a->harmonic ? missed : move;
    double size = INFINITY, mean[2];
    memset(step, 0, (size_t)(2 * plane) * sizeof(double));
    memset(missed, 0, (size_t)(2 * field) * sizeof(double));
    for (int k = a->harmonic ? 0 : 1; k <= a->steps; k++) {
        if (a->around) {
            go_round(a, p, turn, ring);
            find_missed(a, ring, (a->m + 3) * n, k == 0, room, missed, mean);
        } else
            find_missed(a, p, plane, k == 0, room, missed, mean);
        double square = 0.0;
        for (int q = 0; q < 2; q++) {
            invert(a, mean, missed + q * field, other);
            for (ptrdiff_t i = 0; i < a->rows; i++)
                for (ptrdiff_t j = 0; j < n - 2; j++)
                    square += missed[q * field + i * a->width + j] * missed[q * field + i * a->width + j];
        }
        square /= (double)(2 * a->rows * (n - 2));
        if (!(square < a->growth * size)) { /* or not a number */
            memset(step, 0, (size_t)(2 * plane) * sizeof(double));
            memset(missed, 0, (size_t)(2 * field) * sizeof(double));
            continue;
        }
        if (!a->harmonic)
            extrapolate(a, missed, step, move, k == 1);
        size = square;
        for (int q = 0; q < 2; q++)
            for (ptrdiff_t i = 0; i < a->rows; i++) {
                double *to = p + q * plane + (top + i) * n + 1, *taken = step + q * plane + (top + i) * n + 1;
                const ptrdiff_t at = q * field + i * a->width;
                for (ptrdiff_t j = 0; j < n - 2; j++)
                    taken[j] = missed[at + j], to[j] += by[at + j];
            }
    }
    if (a->around)
        for (int q = 0; q < 2; q++)
            for (ptrdiff_t j = 0; j < n; j++) {
                p[q * plane + a->rows * n + j] = p[q * plane + j] + turn[q * n + j];
                step[q * plane + a->rows * n + j] = step[q * plane + j];
            }
}
