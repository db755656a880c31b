/* Winslow's equations in space, and what solves them:

       a11 x_11 + a22 x_22 + a33 x_33 + 2 (a12 x_12 + a13 x_13 + a23 x_23) = f,    x = (x, y, z),
       a11 = g22 g33 - g23², a12 = g13 g23 - g12 g33, and so on: the adjugate of the metric g_de = x_d · x_e,

   by central differences with steps 1 / (n - 1) on 19 nodes, with coefficients of the latest nodes. All lines of a plane
   are relaxed at once, from residuals computed before, and planes in two colours. x, y and z share their factors. */
#include "winslow.h"
#include "clones.h"
#include "team.h"
#include <string.h>

#define TILE 8 /* rows that are turned for lines along zeta */

enum { X, Y, Z, ALONG, ROWS = 6 }; /* residuals, then the three coefficients, of a row of nodes */

typedef struct {
    const Winslow3 *w;
    double factor, *room, *r, *squares;
} Sweep;

static ptrdiff_t longest(const Winslow3 *w)
{
    return w->n1 > w->n2 ? w->n1 : w->n2;
}

static size_t member_room(const Winslow3 *w)
{
    return (size_t)(ROWS * longest(w) * w->n3 + 5 * TILE * w->n3);
}

size_t winslow_room(const Winslow3 *w)
{
    return (size_t)w->n1 + (size_t)w->threads * member_room(w);
}

/* Residuals and coefficients of the row (i, j), `stride` doubles apart. */
MESHONET_CLONES
static void equations(const Winslow3 *w, ptrdiff_t i, ptrdiff_t j, double *restrict out, ptrdiff_t stride)
{
    const ptrdiff_t n3 = w->n3, a = w->n2 * n3, b = n3, nodes = w->n1 * a, at = i * a + j * n3;
    const double m1 = (double)(w->n1 - 1), m2 = (double)(w->n2 - 1), m3 = (double)(n3 - 1);
    const double h1 = 0.5 * m1, h2 = 0.5 * m2, h3 = 0.5 * m3, q1 = m1 * m1, q2 = m2 * m2, q3 = m3 * m3;
    const double m12 = 2.0 * h1 * h2, m13 = 2.0 * h1 * h3, m23 = 2.0 * h2 * h3;
    const double *x = w->x + at, *y = x + nodes, *z = y + nodes;
    double *restrict rx = out, *restrict ry = out + stride, *restrict rz = ry + stride;
    double *restrict c1 = rz + stride, *restrict c2 = c1 + stride, *restrict c3 = c2 + stride;
#define OPERATOR(p)                                                                                                     \
    (a11 * (p[k + a] - 2.0 * p[k] + p[k - a]) + a22 * (p[k + b] - 2.0 * p[k] + p[k - b]) +                              \
     a33 * (p[k + 1] - 2.0 * p[k] + p[k - 1]) +                                                                         \
     a12 * ((p[k + a + b] - p[k + a - b]) - (p[k - a + b] - p[k - a - b])) +                                            \
     a13 * ((p[k + a + 1] - p[k + a - 1]) - (p[k - a + 1] - p[k - a - 1])) +                                            \
     a23 * ((p[k + b + 1] - p[k + b - 1]) - (p[k - b + 1] - p[k - b - 1])))
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 1; k < n3 - 1; k++) {
        const double x1 = h1 * (x[k + a] - x[k - a]), y1 = h1 * (y[k + a] - y[k - a]), z1 = h1 * (z[k + a] - z[k - a]);
        const double x2 = h2 * (x[k + b] - x[k - b]), y2 = h2 * (y[k + b] - y[k - b]), z2 = h2 * (z[k + b] - z[k - b]);
        const double x3 = h3 * (x[k + 1] - x[k - 1]), y3 = h3 * (y[k + 1] - y[k - 1]), z3 = h3 * (z[k + 1] - z[k - 1]);
        const double g11 = x1 * x1 + y1 * y1 + z1 * z1, g22 = x2 * x2 + y2 * y2 + z2 * z2;
        const double g33 = x3 * x3 + y3 * y3 + z3 * z3, g12 = x1 * x2 + y1 * y2 + z1 * z2;
        const double g13 = x1 * x3 + y1 * y3 + z1 * z3, g23 = x2 * x3 + y2 * y3 + z2 * z3;
        const double a11 = q1 * (g22 * g33 - g23 * g23), a22 = q2 * (g11 * g33 - g13 * g13);
        const double a33 = q3 * (g11 * g22 - g12 * g12), a12 = m12 * (g13 * g23 - g12 * g33);
        const double a13 = m13 * (g12 * g23 - g13 * g22), a23 = m23 * (g12 * g13 - g11 * g23);
        rx[k] = -OPERATOR(x), ry[k] = -OPERATOR(y), rz[k] = -OPERATOR(z);
        c1[k] = a11, c2[k] = a22, c3[k] = a33;
    }
    if (!w->f)
        return;
    const double *restrict fx = w->f + at, *restrict fy = fx + nodes, *restrict fz = fy + nodes;
    for (ptrdiff_t k = 1; k < n3 - 1; k++)
        rx[k] += fx[k], ry[k] += fy[k], rz[k] += fz[k];
}

/* Thomas's algorithm for the lines that cross rows 1 .. n - 2 of a plane, coefficient `along` between rows; the
   residuals become corrections. */
MESHONET_CLONES
static void solve_across(double *rows, ptrdiff_t stride, ptrdiff_t n, ptrdiff_t n3, int along)
{
    for (ptrdiff_t t = 1; t < n - 1; t++) {
        double *restrict rx = rows + t * n3, *restrict ry = rx + stride, *restrict rz = ry + stride;
        double *restrict a = rx + along * stride;
        const double *restrict c1 = rx + 3 * stride, *restrict c2 = c1 + stride, *restrict c3 = c2 + stride;
        const double *px = rx - n3, *py = ry - n3, *pz = rz - n3, *pa = a - n3;
        if (t == 1) {
            MESHONET_INDEPENDENT
            for (ptrdiff_t k = 1; k < n3 - 1; k++) {
                const double inverse = -0.5 / (c1[k] + c2[k] + c3[k]), off = a[k];
                rx[k] *= inverse, ry[k] *= inverse, rz[k] *= inverse, a[k] = off * inverse;
            }
            continue;
        }
        MESHONET_INDEPENDENT
        for (ptrdiff_t k = 1; k < n3 - 1; k++) {
            const double off = a[k], inverse = 1.0 / (-2.0 * (c1[k] + c2[k] + c3[k]) - off * pa[k]);
            rx[k] = (rx[k] - off * px[k]) * inverse, ry[k] = (ry[k] - off * py[k]) * inverse;
            rz[k] = (rz[k] - off * pz[k]) * inverse, a[k] = off * inverse;
        }
    }
    for (ptrdiff_t t = n - 3; t >= 1; t--) {
        double *restrict rx = rows + t * n3, *restrict ry = rx + stride, *restrict rz = ry + stride;
        const double *restrict a = rx + along * stride;
        const double *nx = rx + n3, *ny = ry + n3, *nz = rz + n3;
        MESHONET_INDEPENDENT
        for (ptrdiff_t k = 1; k < n3 - 1; k++)
            rx[k] -= a[k] * nx[k], ry[k] -= a[k] * ny[k], rz[k] -= a[k] * nz[k];
    }
}

/* x += factor times the corrections of a row. */
MESHONET_CLONES
static void correct(const Winslow3 *w, ptrdiff_t i, ptrdiff_t j, const double *rows, ptrdiff_t stride, double factor)
{
    const ptrdiff_t at = (i * w->n2 + j) * w->n3, nodes = w->n1 * w->n2 * w->n3;
    for (ptrdiff_t c = 0; c < 3; c++) {
        double *restrict x = w->x + c * nodes + at;
        const double *restrict r = rows + c * stride;
        for (ptrdiff_t k = 1; k < w->n3 - 1; k++)
            x[k] += factor * r[k];
    }
}

/* Lines along xi of the plane j (`xi`), or along eta of the plane i. */
static void relax_plane(const Sweep *s, int xi, ptrdiff_t plane, double *rows)
{
    const Winslow3 *w = s->w;
    const ptrdiff_t n = xi ? w->n1 : w->n2, stride = longest(w) * w->n3;
    for (ptrdiff_t t = 1; t < n - 1; t++)
        equations(w, xi ? t : plane, xi ? plane : t, rows + t * w->n3, stride);
    solve_across(rows, stride, n, w->n3, xi ? ALONG : ALONG + 1);
    for (ptrdiff_t t = 1; t < n - 1; t++)
        correct(w, xi ? t : plane, xi ? plane : t, rows + t * w->n3, stride, s->factor);
}

/* Lines along zeta of TILE rows at once: turned, solved, and turned back into the corrections. */
MESHONET_CLONES
static void solve_tile(double *rows, ptrdiff_t stride, ptrdiff_t count, ptrdiff_t n3, double *tile)
{
    double(*restrict t)[5][TILE] = (double(*)[5][TILE])tile;
    for (ptrdiff_t l = 0; l < TILE; l++) {
        const double *r = rows + (l < count ? l : count - 1) * n3;
        for (ptrdiff_t k = 1; k < n3 - 1; k++) {
            const double c1 = r[3 * stride + k], c2 = r[4 * stride + k], c3 = r[5 * stride + k];
            t[k][0][l] = r[k], t[k][1][l] = r[stride + k], t[k][2][l] = r[2 * stride + k];
            t[k][3][l] = c3, t[k][4][l] = -2.0 * (c1 + c2 + c3);
        }
    }
    for (ptrdiff_t k = 1; k < n3 - 1; k++)
        for (ptrdiff_t l = 0; l < TILE; l++) {
            const double a = t[k][3][l], before = k > 1 ? a : 0.0;
            const double inverse = 1.0 / (t[k][4][l] - before * t[k > 1 ? k - 1 : k][3][l]);
            for (int c = 0; c < 3; c++)
                t[k][c][l] = (t[k][c][l] - before * t[k > 1 ? k - 1 : k][c][l]) * inverse;
            t[k][3][l] = a * inverse;
        }
    for (ptrdiff_t k = n3 - 3; k >= 1; k--)
        for (int c = 0; c < 3; c++)
            for (ptrdiff_t l = 0; l < TILE; l++)
                t[k][c][l] -= t[k][3][l] * t[k + 1][c][l];
    for (ptrdiff_t l = 0; l < count; l++)
        for (int c = 0; c < 3; c++)
            for (ptrdiff_t k = 1; k < n3 - 1; k++)
                rows[l * n3 + c * stride + k] = t[k][c][l];
}

/* Lines along zeta of the plane i. */
static void relax_zeta(const Sweep *s, ptrdiff_t i, double *rows)
{
    const Winslow3 *w = s->w;
    const ptrdiff_t stride = longest(w) * w->n3;
    double *tile = rows + ROWS * stride;
    for (ptrdiff_t j = 1; j < w->n2 - 1; j++)
        equations(w, i, j, rows + j * w->n3, stride);
    for (ptrdiff_t j = 1; j < w->n2 - 1; j += TILE)
        solve_tile(rows + j * w->n3, stride, w->n2 - 1 - j < TILE ? w->n2 - 1 - j : TILE, w->n3, tile);
    for (ptrdiff_t j = 1; j < w->n2 - 1; j++)
        correct(w, i, j, rows + j * w->n3, stride, s->factor);
}

static void smooth_share(void *data, Member member)
{
    const Sweep *s = data;
    double *rows = s->room + s->w->n1 + (size_t)member.rank * member_room(s->w);
    for (int direction = 0; direction < 3; direction++)
        for (ptrdiff_t colour = 0; colour < 2; colour++) {
            const ptrdiff_t planes = (direction == 0 ? s->w->n2 : s->w->n1) - 2;
            const Range mine = team_share((planes + 1 - colour) / 2, member);
            for (ptrdiff_t p = mine.first; p < mine.last; p++) {
                const ptrdiff_t plane = 1 + colour + 2 * p;
                if (direction < 2)
                    relax_plane(s, direction == 0, plane, rows);
                else
                    relax_zeta(s, plane, rows);
            }
            team_wait(member);
        }
}

void winslow_smooth(const Winslow3 *w, double factor, double *room)
{
    Sweep s = {.w = w, .factor = factor, .room = room};
    team_run(w->threads, smooth_share, &s);
}

MESHONET_CLONES
static double store_row(const double *restrict rows, ptrdiff_t n3, double *restrict r, ptrdiff_t nodes)
{
    double sum = 0.0;
    for (ptrdiff_t c = 0; c < 3; c++)
        for (ptrdiff_t k = 1; k < n3 - 1; k++) {
            r[c * nodes + k] = rows[c * n3 + k];
            sum += rows[c * n3 + k] * rows[c * n3 + k];
        }
    return sum;
}

static void residual_share(void *data, Member member)
{
    const Sweep *s = data;
    const Winslow3 *w = s->w;
    const ptrdiff_t face = w->n2 * w->n3, nodes = w->n1 * face;
    double *rows = s->room + w->n1 + (size_t)member.rank * member_room(w);
    const Range mine = team_share(w->n1, member);
    for (ptrdiff_t i = mine.first; i < mine.last; i++) {
        s->squares[i] = 0.0;
        for (ptrdiff_t c = 0; c < 3; c++)
            memset(s->r + c * nodes + i * face, 0, (size_t)face * sizeof *s->r);
        for (ptrdiff_t j = 1; j < w->n2 - 1 && i > 0 && i < w->n1 - 1; j++) {
            equations(w, i, j, rows, w->n3);
            s->squares[i] += store_row(rows, w->n3, s->r + i * face + j * w->n3, nodes);
        }
    }
}

double winslow_residual(const Winslow3 *w, double *r, double *room)
{
    Sweep s = {.w = w, .room = room, .r = r, .squares = room};
    double sum = 0.0;
    team_run(w->threads, residual_share, &s);
    for (ptrdiff_t i = 0; i < w->n1; i++)
        sum += room[i];
    return sum;
}

/* ---- between levels ---- */

typedef struct {
    const double *from;
    ptrdiff_t before, n, after, m;
    const ptrdiff_t *first;
    const double *weights;
    ptrdiff_t terms;
    int add;
    double *to;
} Combination;

/* Rows of `after` values, or single values along the last direction. */
MESHONET_CLONES
static void combine_row(const Combination *c, ptrdiff_t outer, ptrdiff_t row)
{
    const double *w = c->weights + row * c->terms, *from = c->from + (outer * c->n + c->first[row]) * c->after;
    double *restrict to = c->to + (outer * c->m + row) * c->after;
    if (!c->add)
        memset(to, 0, (size_t)c->after * sizeof *to);
    for (ptrdiff_t t = 0; t < c->terms; t++) {
        const double *restrict source = from + t * c->after, weight = w[t];
        if (weight != 0.0)
            for (ptrdiff_t k = 0; k < c->after; k++)
                to[k] += weight * source[k];
    }
}

MESHONET_CLONES
static void combine_values(const Combination *c, ptrdiff_t outer)
{
    const double *from = c->from + outer * c->n;
    double *restrict to = c->to + outer * c->m;
    for (ptrdiff_t row = 0; row < c->m; row++) {
        const double *w = c->weights + row * c->terms, *source = from + c->first[row];
        double sum = c->add ? to[row] : 0.0;
        for (ptrdiff_t t = 0; t < c->terms; t++)
            sum += w[t] * source[t];
        to[row] = sum;
    }
}

static void combine_share(void *data, Member member)
{
    const Combination *c = data;
    const Range mine = team_share(c->after == 1 ? c->before : c->before * c->m, member);
    if (c->after == 1) {
        for (ptrdiff_t outer = mine.first; outer < mine.last; outer++)
            combine_values(c, outer);
        return;
    }
    for (ptrdiff_t each = mine.first; each < mine.last; each++)
        combine_row(c, each / c->m, each % c->m);
}

void combine_along(const double *from, ptrdiff_t before, ptrdiff_t n, ptrdiff_t after, ptrdiff_t m,
                   const ptrdiff_t *first, const double *weights, ptrdiff_t terms, int add, int threads, double *to)
{
    Combination c = {from, before, n, after, m, first, weights, terms, add, to};
    team_run(threads, combine_share, &c);
}
