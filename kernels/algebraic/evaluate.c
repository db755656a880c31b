/* A grid on m x n nodes evaluated inside edges of ni x nj nodes, in one pass over the result.

       x = L X Lᵀ + C (K∘B X) Lᵀ + L (K∘X Bᵀ) Cᵀ + C (K∘B X Bᵀ) Cᵀ + what that misses of the edges, fading inwards

   X are the nodes, L and C weights of values and second derivatives (`places` of spline.py), B second derivatives of
   not-a-knot splines, K the share of these that is left (corner_damping.py). */
#include "evaluate.h"

#include <math.h>
#include <string.h>

#include "clones.h"
#include "inwards.h"
#include "team.h"

enum { TILE = 16 };

/* Second derivatives along the rows of f (m, n): m_k-1 + 4 m_k + m_k+1 = 6 (f_k-1 - 2 f_k + f_k+1). That the third is
   continuous at the second row makes m_0 - 2 m_1 + m_2 = 0, hence m_1; so at the other end. */
MESHONET_INLINE void bend(const double *restrict f, ptrdiff_t m, ptrdiff_t n, double *restrict share, double *second)
{
    if (m < 3) {
        memset(second, 0, (size_t)(m * n) * sizeof *second);
        return;
    }
    memset(second, 0, (size_t)n * sizeof *second); /* not a number, times 0, would stay */
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
    const ptrdiff_t more = m > 3 ? n : 0, last = (m - 1) * n; /* of three rows all have the second derivative of one */
    for (ptrdiff_t j = 0; j < n; j++) {
        second[j] = 2.0 * second[n + j] - second[n + more + j];
        second[last + j] = 2.0 * second[last - n + j] - second[last - n - more + j];
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

/* Multiply fields (count, m, n) by what the openings of the corners and straight lines leave of them. */
MESHONET_INLINE void leave(const Evaluation *e, const Corners *edges, double *restrict share, double *fields, int count)
{
    const double *opened = edges->opened;
    const ptrdiff_t size = e->m * e->n, most = (ptrdiff_t)ceil(e->far);
    const ptrdiff_t rows = most < e->m ? most : e->m, columns = most < e->n ? most : e->n;
    for (ptrdiff_t k = 0; k < size; k++)
        share[k] = edges->straight != NULL && edges->straight[k] ? 0.0 : 1.0;
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

/* out (count) = f (n) at places along a row + what its second derivatives add; four runs of weights. */
MESHONET_INLINE void spread(const double *f, const double *second, ptrdiff_t n, const ptrdiff_t *restrict first,
                            const double *restrict weights, ptrdiff_t count, double *restrict out)
{
    const double *restrict w0 = weights, *restrict w1 = w0 + count, *restrict w2 = w1 + count, *restrict w3 = w2 + count;
    if (count == 2 * n - 1) { /* the nodes themselves and the middles between: nothing to look up */
        const double a = w0[1], b = w1[1], c = w2[1], d = w3[1];
        MESHONET_INDEPENDENT
        for (ptrdiff_t k = 0; k < n - 1; k++) {
            out[2 * k] = f[k];
            out[2 * k + 1] = (a * f[k] + b * f[k + 1]) + (c * second[k] + d * second[k + 1]);
        }
        out[count - 1] = f[n - 1];
        return;
    }
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < count; j++) {
        const ptrdiff_t k = first[j];
        out[j] = (w0[j] * f[k] + w1[j] * f[k + 1]) + (w2[j] * second[k] + w3[j] * second[k + 1]);
    }
}

/* out, at a range of places, = what `spread` makes of values alone. */
MESHONET_INLINE void spread_line(const double *f, const ptrdiff_t *restrict first, const double *restrict weights,
                                 ptrdiff_t count, Range range, double *restrict out)
{
    const double *restrict w0 = weights, *restrict w1 = w0 + count;
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = range.first; j < range.last; j++)
        out[j] = w0[j] * f[first[j]] + w1[j] * f[first[j] + 1];
}

/* x row = the two rows of values and of second derivatives around it. */
MESHONET_INLINE void combine(double *restrict x, const double *w, const double *restrict v0, const double *restrict v1,
                             ptrdiff_t nj)
{
    const double w0 = w[0], w1 = w[1], w2 = w[2], w3 = w[3];
    const double *restrict m0 = v0 + nj, *restrict m1 = v1 + nj;
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < nj; j++)
        x[j] = (w0 * v0[j] + w1 * v1[j]) + (w2 * m0[j] + w3 * m1[j]);
}

/* Rows of values += shares of what is missed (2, nj) of an edge along them; those of y stand two rows after x. */
MESHONET_INLINE void add_share(const double *share, const ptrdiff_t *restrict first, const double *restrict weights,
                               ptrdiff_t nj, const double *restrict missed, double *restrict rows)
{
    const double *restrict w0 = weights, *restrict w1 = w0 + nj;
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < nj; j++) {
        const double felt_here = w0[j] * share[first[j]] + w1[j] * share[first[j] + 1];
        rows[j] += felt_here * missed[j], rows[2 * nj + j] += felt_here * missed[nj + j];
    }
}

/* Rows x and y += what is missed at one end of them times what is felt of it, between two rows of that. */
MESHONET_INLINE void reach_in(double *restrict x, double *restrict y, double dx, double dy, const double *w,
                              const double *restrict low, const double *restrict high, Range range)
{
    const double x0 = dx * w[0], x1 = dx * w[1], y0 = dy * w[0], y1 = dy * w[1];
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = range.first; j < range.last; j++)
        x[j] += x0 * low[j] + x1 * high[j], y[j] += y0 * low[j] + y1 * high[j];
}

ptrdiff_t evaluate_scratch(const Evaluation *e)
{
    const ptrdiff_t size = e->m * e->n, most = e->m > e->n ? e->m : e->n;
    return 8 * e->nj + 14 * size + most + e->threads * 12 * e->nj;
}

/* What a row of the result is made of, and room for it. */
typedef struct {
    double *weights; /* four runs (nj) of the places along eta */
    double *rows;    /* two coarse rows along eta: values of x, second derivatives, the same of y, (4, nj) each */
    double *ends;    /* what is felt of south and north on these, (2, nj) each */
    double *missed;  /* of west and east (2, 2, nj) */
    double *bends;   /* second derivatives along xi, eta and both, of x, then of y, (6, m, n) */
    double *tables;  /* of inwards.h (4, m, n) */
    Range ranges[2][2];
} Parts;

/* Second derivatives, how far edges are felt, and what is missed of west and east. */
MESHONET_CLONES
static void prepare(const Evaluation *e, const double *coarse, const Corners *edges, Parts *p, double *spare)
{
    const ptrdiff_t m = e->m, n = e->n, nj = e->nj, size = m * n;
    double *share = spare + 2 * size;
    for (ptrdiff_t j = 0; j < nj; j++)
        for (int k = 0; k < 4; k++)
            p->weights[k * nj + j] = e->fine[1].weights[4 * j + k];
    for (int c = 0; c < 2; c++) {
        double *xi = p->bends + 3 * c * size, *eta = xi + size;
        turn(coarse + c * size, m, n, spare);
        bend(spare, n, m, share, spare + size);
        turn(spare + size, n, m, eta);
        bend(coarse + c * size, m, n, share, xi);
        bend(eta, m, n, share, eta + size);
    }
    const double *opened = edges->opened;
    if (opened[0] + opened[1] + opened[2] + opened[3] > 0.0 || edges->straight != NULL)
        leave(e, edges, spare, p->bends, 6);
    inwards(coarse, m, n, e->reach, spare, p->tables);
    for (int side = 0; side < 2; side++)
        for (int c = 0; c < 2; c++) {
            const ptrdiff_t row = side ? size - n : 0;
            const double *given = (side ? edges->east : edges->west) + c * nj;
            double *to = p->missed + (2 * side + c) * nj;
            spread(coarse + c * size + row, p->bends + (3 * c + 1) * size + row, n,
                   e->fine[1].first, p->weights, nj, to);
            for (ptrdiff_t j = 0; j < nj; j++)
                to[j] = given[j] - to[j];
        }
}

/* Put coarse row k, at places along eta, into one half of `rows` and `ends`. */
MESHONET_INLINE void hold(const Evaluation *e, const double *coarse, Parts *p, ptrdiff_t k)
{
    const ptrdiff_t n = e->n, nj = e->nj, size = e->m * n, half = k & 1, *columns = e->fine[1].first;
    for (int c = 0; c < 2; c++) {
        const double *xi = p->bends + 3 * c * size + k * n, *eta = xi + size;
        double *to = p->rows + (4 * half + 2 * c) * nj;
        spread(coarse + c * size + k * n, eta, n, columns, p->weights, nj, to);
        spread(xi, eta + size, n, columns, p->weights, nj, to + nj);
    }
    for (int side = 0; side < 2; side++) {
        const double *along = p->tables + side * size + k * n, *across = along + 2 * size;
        double *to = p->ends + (2 * half + side) * nj;
        p->ranges[half][side] = felt(along, n, nj, side);
        memset(to, 0, (size_t)nj * sizeof *to);
        spread_line(along, columns, p->weights, nj, p->ranges[half][side], to);
        double any = 0.0;
        for (ptrdiff_t j = 0; j < n; j++)
            any += across[j];
        if (any > 0.0)
            add_share(across, columns, p->weights, nj, p->missed + 2 * side * nj, p->rows + 4 * half * nj);
    }
}

typedef struct {
    const Evaluation *e;
    const double *coarse;
    const Corners *edges;
    double *scratch, *nodes;
    Parts parts;
} Pass;

MESHONET_CLONES
static void evaluate_rows(const Pass *pass, Parts p, ptrdiff_t start, ptrdiff_t end)
{
    const Evaluation *e = pass->e;
    const Corners *edges = pass->edges;
    const ptrdiff_t ni = e->ni, nj = e->nj;
    double *x = pass->nodes + start * nj, *y = x + ni * nj;
    ptrdiff_t held[2] = {-1, -1}; /* the coarse rows in the halves */
    for (ptrdiff_t i = start; i < end; i++, x += nj, y += nj) {
        const ptrdiff_t first = e->fine[0].first[i];
        for (ptrdiff_t k = first; k < first + 2; k++)
            if (held[k & 1] != k) {
                held[k & 1] = k;
                hold(e, pass->coarse, &p, k);
            }
        const double *w = e->fine[0].weights + 4 * i, *south = edges->south + i, *north = edges->north + i;
        const int low = (int)(first & 1), high = 1 - low;
        combine(x, w, p.rows + 4 * low * nj, p.rows + 4 * high * nj, nj);
        combine(y, w, p.rows + (4 * low + 2) * nj, p.rows + (4 * high + 2) * nj, nj);
        const double dx[2] = {south[0] - x[0], north[0] - x[nj - 1]}, dy[2] = {south[ni] - y[0], north[ni] - y[nj - 1]};
        for (int side = 0; side < 2; side++)
            reach_in(x, y, dx[side], dy[side], w, p.ends + (2 * low + side) * nj, p.ends + (2 * high + side) * nj,
                     joined(p.ranges[low][side], p.ranges[high][side]));
        x[0] = south[0], x[nj - 1] = north[0], y[0] = south[ni], y[nj - 1] = north[ni];
    }
}

/* Rows of one thread, with two coarse rows of its own. */
static void evaluate_share(void *data, Member member)
{
    const Pass *pass = data;
    const ptrdiff_t nj = pass->e->nj;
    Parts own = pass->parts;
    own.rows = pass->scratch + member.rank * 12 * nj, own.ends = own.rows + 8 * nj;
    const Range mine = team_share(pass->e->ni, member);
    evaluate_rows(pass, own, mine.first, mine.last);
}

void evaluate_grid(const Evaluation *e, const double *coarse, const Corners *edges, double *scratch, double *nodes)
{
    const ptrdiff_t ni = e->ni, nj = e->nj, size = e->m * e->n;
    double *rows = scratch + 8 * nj, *bends = rows + e->threads * 12 * nj, *x = nodes, *y = nodes + ni * nj;
    Pass pass = {e, coarse, edges, rows, nodes,
                 {scratch, NULL, NULL, scratch + 4 * nj, bends, bends + 6 * size, {{{0, 0}}}}};
    prepare(e, coarse, edges, &pass.parts, bends + 10 * size);
    team_run(e->threads, evaluate_share, &pass);
    const size_t line = (size_t)nj * sizeof *x;
    const ptrdiff_t last = (ni - 1) * nj;
    memcpy(x, edges->west, line), memcpy(y, edges->west + nj, line);
    memcpy(x + last, edges->east, line), memcpy(y + last, edges->east + nj, line);
}

typedef struct {
    double *x;
    ptrdiff_t ni, nj;
    const ptrdiff_t *first;
    const double *weights, *values, *bends;
    int rim;
} Combine;

MESHONET_CLONES
static void add_rows(const Combine *c, ptrdiff_t start, ptrdiff_t end)
{
    const ptrdiff_t nj = c->nj, from = c->rim ? 0 : 1;
    for (ptrdiff_t i = start + from; i < end + from; i++) {
        const double *weights = c->weights + 4 * i, w0 = weights[0], w1 = weights[1], w2 = weights[2], w3 = weights[3];
        const double *restrict v0 = c->values + c->first[i] * nj, *restrict v1 = v0 + nj;
        const double *restrict m0 = c->bends + c->first[i] * nj, *restrict m1 = m0 + nj;
        double *restrict row = c->x + i * nj;
        for (ptrdiff_t j = 1; j < nj - 1; j++)
            row[j] += (w0 * v0[j] + w1 * v1[j]) + (w2 * m0[j] + w3 * m1[j]);
    }
}

TEAM_ROWS(combine_share, Combine, task->rim ? task->ni : task->ni - 2, add_rows)

void combine_rows(double *x, ptrdiff_t ni, ptrdiff_t nj, const ptrdiff_t *first, const double *weights,
                  const double *values, const double *bends, int rim, int threads)
{
    Combine combine = {x, ni, nj, first, weights, values, bends, rim};
    team_run(threads, combine_share, &combine);
}
