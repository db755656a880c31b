#include "blend.h"
#include "clones.h"
#include "team.h"
#include <math.h>

enum { LEAST = 64 }; /* points that are worth a thread of their own */
static const double TINY = 1e-280; /* keeps a sum from being 0 */

/* 1/r^2 with a guard for a point on a place, which then has all the weight that counts. */
MESHONET_INLINE double inverse_square(double square) { return 1.0 / (square > 1e-140 ? square : 1e-140); }

MESHONET_INLINE void blend2(const BlendSources *from, double px, double py, double *restrict u, double *restrict v)
{
    const ptrdiff_t n = from->n;
    const double *restrict x = from->place, *restrict y = x + n, *restrict area = from->area;
    const double *restrict a = from->motion, *restrict b = a + n, *restrict xx = b + n, *restrict xy = xx + n,
                           *restrict yx = xy + n, *restrict yy = yx + n;
    const double near2 = from->near2;
    double sum = TINY, su = 0.0, sv = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double dx = px - x[k], dy = py - y[k], inverse = inverse_square(dx * dx + dy * dy);
        const double weight = area[k] * inverse * (1.0 + near2 * inverse);
        sum += weight;
        su += weight * (a[k] + xx[k] * px + xy[k] * py);
        sv += weight * (b[k] + yx[k] * px + yy[k] * py);
    }
    *u = su / sum, *v = sv / sum;
}

MESHONET_INLINE double weight3(double square, double area, double near2)
{
    const double inverse = inverse_square(square);
    return area * inverse * sqrt(inverse) * (1.0 + near2 * inverse);
}

MESHONET_INLINE void blend3(const BlendSources *from, const double *p, double *restrict out)
{
    const ptrdiff_t n = from->n;
    const double *restrict x = from->place, *restrict y = x + n, *restrict z = y + n, *restrict area = from->area;
    const double *restrict m = from->motion;
    const double near2 = from->near2, px = p[0], py = p[1], pz = p[2];
    double sum = TINY, su = 0.0, sv = 0.0, sw = 0.0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double dx = px - x[k], dy = py - y[k], dz = pz - z[k];
        const double weight = weight3(dx * dx + dy * dy + dz * dz, area[k], near2);
        sum += weight;
        su += weight * (m[k] + m[3 * n + k] * px + m[4 * n + k] * py + m[5 * n + k] * pz);
        sv += weight * (m[n + k] + m[6 * n + k] * px + m[7 * n + k] * py + m[8 * n + k] * pz);
        sw += weight * (m[2 * n + k] + m[9 * n + k] * px + m[10 * n + k] * py + m[11 * n + k] * pz);
    }
    out[0] = su / sum, out[1] = sv / sum, out[2] = sw / sum;
}

typedef struct {
    const BlendSources *from;
    const double *x;
    ptrdiff_t m;
    double *moved;
} BlendJob;

MESHONET_CLONES
static void blend_share(const BlendJob *job, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t m = job->m;
    const double *x = job->x;
    double *moved = job->moved;
    if (job->from->axes == 2) {
        for (ptrdiff_t i = first; i < last; i++)
            blend2(job->from, x[i], x[m + i], moved + i, moved + m + i);
        return;
    }
    for (ptrdiff_t i = first; i < last; i++) {
        const double p[3] = {x[i], x[m + i], x[2 * m + i]};
        double d[3];
        blend3(job->from, p, d);
        for (int axis = 0; axis < 3; axis++)
            moved[axis * m + i] = d[axis];
    }
}

static void blend_work(void *data, Member member)
{
    const BlendJob *job = data;
    ptrdiff_t first, last;
    team_share(job->m, member, &first, &last);
    blend_share(job, first, last);
}

void blend_motions(const BlendSources *from, const double *x, ptrdiff_t m, int threads, double *moved)
{
    BlendJob job = {from, x, m, moved};
    const ptrdiff_t most = m / LEAST + 1;
    team_run(most < threads ? (int)most : threads, blend_work, &job);
}

MESHONET_INLINE void gather2(const BlendSources *from, const double *p, const double *g, double *restrict weight,
                             double *restrict to)
{
    const ptrdiff_t n = from->n;
    const double *restrict x = from->place, *restrict y = x + n, *restrict area = from->area;
    const double near2 = from->near2, px = p[0], py = p[1];
    double sum = TINY;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double dx = px - x[k], dy = py - y[k], inverse = inverse_square(dx * dx + dy * dy);
        weight[k] = area[k] * inverse * (1.0 + near2 * inverse);
        sum += weight[k];
    }
    const double u = g[0] / sum, v = g[1] / sum;
    double *restrict a = to, *restrict b = a + n, *restrict xx = b + n, *restrict xy = xx + n, *restrict yx = xy + n,
                     *restrict yy = yx + n;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double du = u * weight[k], dv = v * weight[k];
        a[k] += du, b[k] += dv;
        xx[k] += du * px, xy[k] += du * py;
        yx[k] += dv * px, yy[k] += dv * py;
    }
}

MESHONET_INLINE void gather3(const BlendSources *from, const double *p, const double *g, double *restrict weight,
                             double *restrict to)
{
    const ptrdiff_t n = from->n;
    const double *restrict x = from->place, *restrict y = x + n, *restrict z = y + n, *restrict area = from->area;
    const double near2 = from->near2;
    double sum = TINY;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double dx = p[0] - x[k], dy = p[1] - y[k], dz = p[2] - z[k];
        weight[k] = weight3(dx * dx + dy * dy + dz * dz, area[k], near2);
        sum += weight[k];
    }
    for (int row = 0; row < 3; row++) {
        const double pull = g[row] / sum;
        double *restrict a = to + row * n;
        MESHONET_INDEPENDENT
        for (ptrdiff_t k = 0; k < n; k++)
            a[k] += pull * weight[k];
        for (int column = 0; column < 3; column++) {
            double *restrict b = to + (3 + 3 * row + column) * n;
            const double arm = pull * p[column];
            MESHONET_INDEPENDENT
            for (ptrdiff_t k = 0; k < n; k++)
                b[k] += arm * weight[k];
        }
    }
}

MESHONET_CLONES
void blend_transposed(const BlendSources *from, const double *x, const double *pull, ptrdiff_t m, double *weight,
                      double *gathered)
{
    const int axes = from->axes;
    for (ptrdiff_t k = 0; k < from->n * (axes + axes * axes); k++)
        gathered[k] = 0.0;
    for (ptrdiff_t i = 0; i < m; i++) {
        double p[3] = {0}, g[3] = {0};
        for (int axis = 0; axis < axes; axis++)
            p[axis] = x[axis * m + i], g[axis] = pull[axis * m + i];
        if (g[0] == 0.0 && g[1] == 0.0 && g[2] == 0.0)
            continue;
        if (axes == 2)
            gather2(from, p, g, weight, gathered);
        else
            gather3(from, p, g, weight, gathered);
    }
}
