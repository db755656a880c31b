/* Rows of the grid, one after another: sums over columns (waves.py), maps to the plane (lift_maps.h), and products of
   panels' points with a matrix. A row stays in the first-level cache. */

#include "strip_rows.h"
#include "lanes.h"
#include "lift_maps.h"
#include "team.h"

#define ROWS 4 /* of a product at a time */

/* The points of a row: psi and phi, then x and y; room for LANES more than there are. */
typedef struct { double *x, *y; } Row;

/* `vectors` of LANES points from l on; what is added behind the last point of a row is zero. */
MESHONET_INLINE void gather(double *restrict out, const double *const *taken, const double *weights, ptrdiff_t l,
                            const int vectors)
{
    Lanes sum[4];
#pragma GCC unroll 4
    for (int v = 0; v < vectors; v++) sum[v] = OF(out + l + v * LANES);
    for (int t = 0; t < TAPS; t++)
#pragma GCC unroll 4
        for (int v = 0; v < vectors; v++) sum[v] += weights[t] * OF(taken[t] + l + v * LANES);
#pragma GCC unroll 4
    for (int v = 0; v < vectors; v++) AT(out + l + v * LANES) = sum[v];
}

MESHONET_INLINE void gather_all(double *restrict out, const double *const *taken, const double *weights, ptrdiff_t m)
{
    ptrdiff_t l = 0;
    for (; l + 4 * LANES <= m; l += 4 * LANES) gather(out, taken, weights, l, 4);
    for (; l < m; l += LANES) gather(out, taken, weights, l, 1);
}

/* Add the sum at node i of n to its points; waves.py has the window. */
MESHONET_INLINE void add_sum(const WindowSum *s, double sharpness, ptrdiff_t i, ptrdiff_t n, Row row)
{
    const double place = (double)i * (double)s->count / (double)n, first = ceil(place - 0.5 * TAPS);
    const double *re[TAPS], *im[TAPS];
    double weights[TAPS];
    for (int t = 0; t < TAPS; t++) {
        const double u = (first + t - place) / (0.5 * TAPS), inside = 1.0 - u * u;
        weights[t] = exp_double(sharpness * (sqrt(inside > 0.0 ? inside : 0.0) - 1.0));
        re[t] = s->columns + (((ptrdiff_t)first + t) & (s->count - 1)) * 2 * s->width;
        im[t] = re[t] + s->width;
    }
    gather_all(row.x + s->from, re, weights, s->m);
    gather_all(row.y + s->from, im, weights, s->m);
}

MESHONET_CLONES
static void make_row(const StripRows *s, ptrdiff_t i, Row row)
{
    const double theta = 6.283185307179586476925 / (double)s->n * (double)i;
    for (ptrdiff_t l = 0; l < s->m; l++) row.x[l] = 0.0, row.y[l] = theta;
    for (ptrdiff_t k = 0; k < s->n_sums; k++) add_sum(&s->sums[k], s->sharpness, i, s->n, row);
    for (ptrdiff_t k = 0; k < s->n_nudges; k++) {
        const double along = s->along[k * s->n + i];
        if (along != 0.0)
            for (ptrdiff_t l = 0; l < s->m; l++) row.y[l] += along * s->across[k * s->m + l];
    }
    for (ptrdiff_t l = 0; l < s->m; l += CHUNK)
        lift_to_plane(row.x + l, row.y + l, s->m - l < CHUNK ? s->m - l : CHUNK, &s->lift);
}

/* a and b become the means of each with the mirror image of the other. */
MESHONET_INLINE void make_symmetric(const StripRows *s, Row a, Row b)
{
    const Cplx o = s->on_axis, t = s->turned;
    for (ptrdiff_t l = 0; l < s->m; l++) {
        const double ax = a.x[l] - o.re, ay = a.y[l] - o.im, bx = b.x[l] - o.re, by = b.y[l] - o.im;
        const double px = t.re * bx + t.im * by, py = t.im * bx - t.re * by; /* t conj(b) */
        const double mx = 0.5 * (ax + px), my = 0.5 * (ay + py);
        a.x[l] = o.re + mx, a.y[l] = o.im + my;
        b.x[l] = o.re + t.re * mx + t.im * my, b.y[l] = o.im + t.im * mx - t.re * my;
    }
}

/* `count` rows of one coordinate on one panel, levels [from, to); c[r] are the values at its points */
MESHONET_INLINE void lay(double *const *out, int count, double (*c)[PANEL_NODES],
                         const double *restrict matrix, ptrdiff_t width, ptrdiff_t from, ptrdiff_t to)
{
    ptrdiff_t j = from;
    if (count == ROWS)
        for (; j + LANES <= to; j += LANES) {
            Lanes sum[ROWS] = {{0}};
            for (int k = 0; k < PANEL_NODES; k++)
#pragma GCC unroll 4
                for (int r = 0; r < ROWS; r++) sum[r] += c[r][k] * OF(matrix + k * width + j);
#pragma GCC unroll 4
            for (int r = 0; r < ROWS; r++) AT(out[r] + j) = sum[r];
        }
    for (; j < to; j++)
        for (int r = 0; r < count; r++) {
            double sum = 0.0;
            for (int k = 0; k < PANEL_NODES; k++) sum += c[r][k] * matrix[k * width + j];
            out[r][j] = sum;
        }
}

/* One coordinate of the points of `count` rows to their levels. */
MESHONET_INLINE void write_levels(const StripRows *s, double *const *points, int count, double *const *out,
                                  ptrdiff_t nj)
{
    const ptrdiff_t near = s->begin - 1, last = near + PANEL_NODES * s->panels, width = s->cuts[s->panels];
    double *levels[ROWS];
    for (int r = 0; r < count; r++) {
        for (ptrdiff_t l = 0; l < near; l++) out[r][1 + l] = points[r][l];
        for (ptrdiff_t l = last; l < s->m; l++) out[r][nj - 1 - s->m + l] = points[r][l];
        levels[r] = out[r] + s->begin;
    }
    for (ptrdiff_t p = 0; p < s->panels; p++) {
        double c[ROWS][PANEL_NODES];
        for (int r = 0; r < count; r++)
            for (int k = 0; k < PANEL_NODES; k++) c[r][k] = points[r][near + PANEL_NODES * p + k];
        lay(levels, count, c, s->matrix, width, s->cuts[p], s->cuts[p + 1]);
    }
}

MESHONET_INLINE double some_rows(const StripRows *s, const ptrdiff_t *order, int count, double *x, double *y,
                                 ptrdiff_t nj, double *const *px, double *const *py)
{
    double *to_x[ROWS], *to_y[ROWS], sum = 0.0;
    for (int r = 0; r < count; r++) {
        make_row(s, order[r], (Row){px[r], py[r]});
        to_x[r] = x + order[r] * nj, to_y[r] = y + order[r] * nj;
    }
    if (s->symmetric)
        for (int r = 0; r + 1 < count; r += 2) make_symmetric(s, (Row){px[r], py[r]}, (Row){px[r + 1], py[r + 1]});
    write_levels(s, px, count, to_x, nj);
    write_levels(s, py, count, to_y, nj);
    for (int r = 0; r < count; r++)
        for (ptrdiff_t l = 0; l < s->m; l++) sum += px[r][l] + py[r][l];
    return sum;
}

/* What a team writes: rows in groups of ROWS, of which the last may be fewer. */
typedef struct {
    const StripRows *s;
    const ptrdiff_t *order;
    ptrdiff_t count, nj;
    double *x, *y, *scratch;
    double sums[TEAM_MOST];
} Pass;

MESHONET_CLONES
static double groups(const Pass *p, ptrdiff_t i, ptrdiff_t end, double *scratch)
{
    const StripRows *s = p->s;
    double *px[ROWS], *py[ROWS], sum = 0.0;
    for (int r = 0; r < ROWS; r++) px[r] = scratch + 2 * r * (s->m + LANES), py[r] = px[r] + s->m + LANES;
    for (; i + ROWS <= end; i += ROWS) sum += some_rows(s, p->order + i, ROWS, p->x, p->y, p->nj, px, py);
    for (; i < end; i += 2) sum += some_rows(s, p->order + i, end - i < 2 ? 1 : 2, p->x, p->y, p->nj, px, py);
    return sum;
}

static void share(void *data, Member member)
{
    Pass *p = data;
    const Range mine = team_share((p->count + ROWS - 1) / ROWS, member);
    const ptrdiff_t end = ROWS * mine.last < p->count ? ROWS * mine.last : p->count;
    p->sums[member.rank] = groups(p, ROWS * mine.first, end, p->scratch + 8 * member.rank * (p->s->m + LANES));
}

double strip_rows(const StripRows *s, const ptrdiff_t *order, ptrdiff_t count, double *x, double *y, ptrdiff_t nj,
                  int threads, double *scratch)
{
    Pass pass = {s, order, count, nj, x, y, scratch, {0.0}};
    double sum = 0.0;
    team_run(threads, share, &pass);
    for (int k = 0; k < TEAM_MOST; k++) sum += pass.sums[k];
    return sum;
}
