/* A grid on m x n nodes evaluated inside edges of ni x nj nodes, in one pass over the result.

       x = TFI + L D Lᵀ + C (K∘B D) Lᵀ + L (K∘D Bᵀ) Cᵀ + C (K∘B D Bᵀ) Cᵀ

   with D what the grid differs from the interpolation of its own edges by, L and C the weights of values and of
   second derivatives (`places` of spline.py), B second derivatives of not-a-knot splines, and K the share of them
   that acute corners leave (acute.py). Rows of the sum along eta are made when the pass reaches them. */
#include "evaluate_kernel.h"

#include <math.h>
#include <string.h>

#include "clones.h"
#include "tfi_row.h"

enum { TILE = 16 };

/* Length up to each node over the whole edge's, 0 to 1. */
MESHONET_INLINE void law(const double *restrict x, const double *restrict y, ptrdiff_t n, double *restrict along)
{
    double sum = 0.0;
    along[0] = 0.0;
    for (ptrdiff_t k = 1; k < n; k++) {
        const double dx = x[k] - x[k - 1], dy = y[k] - y[k - 1];
        along[k] = sqrt(dx * dx + dy * dy);
    }
    for (ptrdiff_t k = 1; k < n; k++)
        along[k] = sum += along[k];
    for (ptrdiff_t k = 1; k < n - 1; k++)
        along[k] /= sum;
    along[n - 1] = 1.0;
}

/* Values linear between those at the full number of places. */
MESHONET_INLINE void thinned(const double *values, const Places *at, ptrdiff_t n, double *restrict out)
{
    for (ptrdiff_t k = 0; k < n; k++) {
        const double *from = values + at->first[k];
        out[k] = at->weights[4 * k] * from[0] + at->weights[4 * k + 1] * from[1];
    }
}

/* Second derivatives along the rows of f (m, n): m_k-1 + 4 m_k + m_k+1 = 6 (f_k-1 - 2 f_k + f_k+1). That the third is
   continuous at the second row makes m_0 - 2 m_1 + m_2 = 0, hence m_1; so at the other end. */
MESHONET_INLINE void bend(const double *restrict f, ptrdiff_t m, ptrdiff_t n, double *restrict share, double *second)
{
    if (m < 3) {
        memset(second, 0, (size_t)(m * n) * sizeof *second);
        return;
    }
    for (ptrdiff_t k = 1; k < m - 1; k++) {
        const double *restrict at = f + k * n, *restrict before = second + (k - 1) * n;
        double *restrict row = second + k * n;
        const int end = k == 1 || k == m - 2;
        share[k] = end ? 0.0 : 1.0 / (4.0 - share[k - 1]);
        const double whole = end ? 1.0 : 6.0 * share[k], less = share[k];
        for (ptrdiff_t j = 0; j < n; j++)
            row[j] = whole * (at[j - n] - 2.0 * at[j] + at[j + n]) - less * before[j];
    }
    for (ptrdiff_t k = m - 3; k > 1; k--) {
        double *restrict row = second + k * n;
        const double *restrict after = row + n;
        for (ptrdiff_t j = 0; j < n; j++)
            row[j] -= share[k] * after[j];
    }
    const ptrdiff_t inner = m > 3, last = (m - 1) * n;
    for (ptrdiff_t j = 0; j < n; j++) {
        second[j] = (1.0 + (double)inner) * second[n + j] - (double)inner * second[2 * n + j];
        second[last + j] = (1.0 + (double)inner) * second[last - n + j] - (double)inner * second[last - 2 * n + j];
    }
}

/* to (n, m) = from (m, n) turned over. */
MESHONET_INLINE void turn(const double *restrict from, ptrdiff_t m, ptrdiff_t n, double *restrict to)
{
    for (ptrdiff_t i = 0; i < m; i += TILE)
        for (ptrdiff_t j = 0; j < n; j += TILE)
            for (ptrdiff_t k = i; k < (i + TILE < m ? i + TILE : m); k++)
                for (ptrdiff_t l = j; l < (j + TILE < n ? j + TILE : n); l++)
                    to[l * m + k] = from[k * n + l];
}

/* Multiply fields (count, m, n) by what the openings of the corners leave of them. */
MESHONET_INLINE void leave(const Evaluation *e, const double *opened, double *restrict share, double *fields, int count)
{
    const ptrdiff_t size = e->m * e->n, most = (ptrdiff_t)ceil(e->far);
    const ptrdiff_t rows = most < e->m ? most : e->m, columns = most < e->n ? most : e->n;
    for (ptrdiff_t k = 0; k < size; k++)
        share[k] = 1.0;
    for (int corner = 0; corner < 4; corner++)
        for (ptrdiff_t i = 0; i < rows && opened[corner] > 0.0; i++)
            for (ptrdiff_t j = 0; j < columns; j++) {
                const double cells = (double)(i > j ? i : j), faded = (e->far - cells) / (e->far - e->near);
                const double left = 1.0 - opened[corner] * (faded > 1.0 ? 1.0 : faded);
                double *at = share + (corner & 2 ? e->m - 1 - i : i) * e->n + (corner & 1 ? e->n - 1 - j : j);
                *at = left < *at ? left : *at;
            }
    for (int c = 0; c < count; c++)
        for (ptrdiff_t k = 0; k < size; k++)
            fields[c * size + k] *= share[k];
}

/* out (count) = f at places along a row + what its second derivatives add; four runs of weights. */
MESHONET_INLINE void spread(const double *f, const double *second, const ptrdiff_t *restrict first,
                            const double *restrict weights, ptrdiff_t count, double *restrict out)
{
    const double *restrict w0 = weights, *restrict w1 = w0 + count, *restrict w2 = w1 + count, *restrict w3 = w2 + count;
    for (ptrdiff_t j = 0; j < count; j++) {
        const ptrdiff_t k = first[j];
        out[j] = (w0[j] * f[k] + w1[j] * f[k + 1]) + (w2[j] * second[k] + w3[j] * second[k + 1]);
    }
}

/* The difference D (2, m, n) of a grid from the interpolation of its edges by the laws of the full ones. */
MESHONET_INLINE void differ(const Evaluation *e, const double *coarse, const TfiEdges *full, double *room, double *d)
{
    const ptrdiff_t m = e->m, n = e->n, size = m * n;
    double *laws = room, *rim = room + 2 * (m + n);
    const TfiEdges along = {laws, laws + m, laws + 2 * m, laws + 2 * m + n};
    thinned(full->south, &e->thin[0], m, laws);
    thinned(full->north, &e->thin[0], m, laws + m);
    thinned(full->west, &e->thin[1], n, laws + 2 * m);
    thinned(full->east, &e->thin[1], n, laws + 2 * m + n);
    TfiEdges edges[2];
    for (int c = 0; c < 2; c++, rim += 2 * m) {
        const double *z = coarse + c * size;
        for (ptrdiff_t i = 0; i < m; i++)
            rim[i] = z[i * n], rim[m + i] = z[i * n + n - 1];
        edges[c] = (TfiEdges){rim, rim + m, z, z + size - n};
    }
    for (int c = 0; c < 2; c++) {
        memset(d + c * size, 0, (size_t)n * sizeof *d);
        memset(d + (c + 1) * size - n, 0, (size_t)n * sizeof *d);
    }
    for (ptrdiff_t i = 1; i < m - 1; i++) {
        fill_row(d + i * n, d + size + i * n, i, m, n, &edges[0], &edges[1], &along);
        for (int c = 0; c < 2; c++)
            for (ptrdiff_t k = c * size + i * n, j = 0; j < n; j++, k++)
                d[k] = coarse[k] - d[k];
    }
}

/* x row i += the two rows of values and of second derivatives around it. */
MESHONET_INLINE void add(double *restrict x, const double *w, const double *restrict v0, const double *restrict v1,
                         ptrdiff_t nj)
{
    const double w0 = w[0], w1 = w[1], w2 = w[2], w3 = w[3];
    const double *restrict m0 = v0 + nj, *restrict m1 = v1 + nj;
    for (ptrdiff_t j = 1; j < nj - 1; j++)
        x[j] += (w0 * v0[j] + w1 * v1[j]) + (w2 * m0[j] + w3 * m1[j]);
}

MESHONET_CLONES
void evaluate_begin(const Evaluation *e, const Corners *edges, double *scratch, double *nodes)
{
    const ptrdiff_t m = e->m, n = e->n, half = m + n;
    const double *given[4] = {edges->south, edges->north, edges->west, edges->east};
    double *at[3][4]; /* x, y and laws of the four sides */
    for (int k = 0; k < 3; k++) {
        double *first = scratch + 2 * k * half;
        at[k][0] = first, at[k][1] = first + m, at[k][2] = first + 2 * m, at[k][3] = first + 2 * m + n;
    }
    for (int side = 0; side < 4; side++) {
        const int eta = side / 2;
        const ptrdiff_t count = eta ? n : m, full = eta ? e->nj : e->ni;
        thinned(given[side], &e->thin[eta], count, at[0][side]);
        thinned(given[side] + full, &e->thin[eta], count, at[1][side]);
        law(at[0][side], at[1][side], count, at[2][side]);
    }
    TfiEdges three[3];
    for (int k = 0; k < 3; k++)
        three[k] = (TfiEdges){at[k][0], at[k][1], at[k][2], at[k][3]};
    double *x = nodes, *y = nodes + m * n;
    for (int side = 2; side < 4; side++) {
        const ptrdiff_t row = side == 2 ? 0 : m - 1;
        memcpy(x + row * n, at[0][side], (size_t)n * sizeof *x), memcpy(y + row * n, at[1][side], (size_t)n * sizeof *y);
    }
    for (ptrdiff_t i = 1; i < m - 1; i++)
        fill_row(x + i * n, y + i * n, i, m, n, &three[0], &three[1], &three[2]);
}

ptrdiff_t evaluate_scratch(const Evaluation *e)
{
    const ptrdiff_t size = e->m * e->n, most = e->m > e->n ? e->m : e->n;
    return 2 * (e->ni + e->nj) + 2 * (e->m + e->n) + 4 * e->m + 12 * e->nj + 10 * size + most;
}

MESHONET_CLONES
void evaluate_grid(const Evaluation *e, const double *coarse, const Corners *edges, double *scratch, double *nodes)
{
    const ptrdiff_t m = e->m, n = e->n, ni = e->ni, nj = e->nj, size = m * n;
    double *laws = scratch, *room = laws + 2 * (ni + nj), *weights = room + 2 * (m + n) + 4 * m;
    double *rows = weights + 4 * nj, *d = rows + 8 * nj, *spare = d + 8 * size, *share = spare + 2 * size;
    const TfiEdges along = {laws, laws + ni, laws + 2 * ni, laws + 2 * ni + nj};
    const TfiEdges ex = {edges->south, edges->north, edges->west, edges->east};
    const TfiEdges ey = {ex.south + ni, ex.north + ni, ex.west + nj, ex.east + nj};
    law(ex.south, ey.south, ni, laws);
    law(ex.north, ey.north, ni, laws + ni);
    law(ex.west, ey.west, nj, laws + 2 * ni);
    law(ex.east, ey.east, nj, laws + 2 * ni + nj);
    differ(e, coarse, &along, room, d);
    for (ptrdiff_t j = 0; j < nj; j++)
        for (int k = 0; k < 4; k++)
            weights[k * nj + j] = e->fine[1].weights[4 * j + k];

    double *bends = d + 2 * size; /* along xi, along eta and both, of x, then of y */
    for (int c = 0; c < 2; c++) {
        double *xi = bends + 3 * c * size, *eta = xi + size;
        turn(d + c * size, m, n, spare);
        bend(spare, n, m, share, spare + size);
        turn(spare + size, n, m, eta);
        bend(d + c * size, m, n, share, xi);
        bend(eta, m, n, share, eta + size);
    }
    const double *opened = edges->opened;
    if (opened[0] + opened[1] + opened[2] + opened[3] > 0.0)
        leave(e, opened, spare, bends, 6);

    double *x = nodes, *y = nodes + ni * nj;
    memcpy(x, ex.west, (size_t)nj * sizeof *x), memcpy(y, ey.west, (size_t)nj * sizeof *y);
    ptrdiff_t held[2] = {-1, -1}; /* the rows k of the coarse grid that stand in the halves of `rows` */
    for (ptrdiff_t i = 1; i < ni - 1; i++) {
        x += nj, y += nj;
        const ptrdiff_t first = e->fine[0].first[i];
        for (ptrdiff_t k = first; k < first + 2; k++) {
            if (held[k & 1] == k)
                continue;
            held[k & 1] = k;
            for (int c = 0; c < 2; c++) {
                const double *xi = bends + 3 * c * size + k * n, *eta = xi + size;
                double *to = rows + (4 * (k & 1) + 2 * c) * nj;
                spread(d + c * size + k * n, eta, e->fine[1].first, weights, nj, to);
                spread(xi, eta + size, e->fine[1].first, weights, nj, to + nj);
            }
        }
        fill_row(x, y, i, ni, nj, &ex, &ey, &along);
        const double *low = rows + 4 * (first & 1) * nj, *high = rows + 4 * (~first & 1) * nj;
        add(x, e->fine[0].weights + 4 * i, low, high, nj);
        add(y, e->fine[0].weights + 4 * i, low + 2 * nj, high + 2 * nj, nj);
    }
    x += nj, y += nj;
    memcpy(x, ex.east, (size_t)nj * sizeof *x), memcpy(y, ey.east, (size_t)nj * sizeof *y);
}
