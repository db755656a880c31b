#include "blend.h"
#include "clones.h"
#include "team.h"
#include <math.h>

enum { LEAST = 64 }; /* points that are worth a thread of their own */
static const double TINY = 1e-280; /* keeps a sum from being 0 */

/* 1/r^2 with a guard for a point on a place, which then has all the weight that counts. */
MESHONET_INLINE double inverse_square(double square) { return 1.0 / (square > 1e-140 ? square : 1e-140); }

MESHONET_INLINE double weight_of(const BlendSources *from, ptrdiff_t k, const double *p, const int axes)
{
    double square = 0.0;
    for (int axis = 0; axis < axes; axis++) {
        const double d = p[axis] - from->place[axis * from->n + k];
        square += d * d;
    }
    const double inverse = inverse_square(square), root = axes == 3 ? sqrt(inverse) : 1.0;
    return from->area[k] * inverse * root * (1.0 + from->near2 * inverse);
}

MESHONET_INLINE void blend(const BlendSources *from, const double *p, double *moved, const int axes)
{
    const ptrdiff_t n = from->n;
    double sum = TINY, sums[3] = {0};
    for (ptrdiff_t k = 0; k < n; k++) {
        const double weight = weight_of(from, k, p, axes), *motion = from->motion + k;
        sum += weight;
        for (int row = 0; row < axes; row++) {
            double d = motion[row * n];
            for (int column = 0; column < axes; column++)
                d += motion[(axes + axes * row + column) * n] * p[column];
            sums[row] += weight * d;
        }
    }
    for (int row = 0; row < axes; row++)
        moved[row] = sums[row] / sum;
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
    const int axes = job->from->axes;
    for (ptrdiff_t i = first; i < last; i++) {
        double p[3] = {0}, d[3];
        for (int axis = 0; axis < axes; axis++)
            p[axis] = job->x[axis * m + i];
        if (axes == 2)
            blend(job->from, p, d, 2);
        else
            blend(job->from, p, d, 3);
        for (int axis = 0; axis < axes; axis++)
            job->moved[axis * m + i] = d[axis];
    }
}

TEAM_ROWS(blend_work, BlendJob, task->m, blend_share)

void blend_motions(const BlendSources *from, const double *x, ptrdiff_t m, int threads, double *moved)
{
    BlendJob job = {from, x, m, moved};
    const ptrdiff_t most = m / LEAST + 1;
    team_run(most < threads ? (int)most : threads, blend_work, &job);
}

MESHONET_CLONES
void blend_transposed(const BlendSources *from, const double *x, const double *pull, ptrdiff_t m, double *weight,
                      double *gathered)
{
    const ptrdiff_t n = from->n;
    for (ptrdiff_t k = 0; k < 6 * n; k++)
        gathered[k] = 0.0;
    for (ptrdiff_t i = 0; i < m; i++) {
        const double p[2] = {x[i], x[m + i]}, g[2] = {pull[i], pull[m + i]};
        double sum = TINY;
        if (g[0] == 0.0 && g[1] == 0.0)
            continue;
        for (ptrdiff_t k = 0; k < n; k++) {
            weight[k] = weight_of(from, k, p, 2);
            sum += weight[k];
        }
        for (int row = 0; row < 2; row++) {
            const double share = g[row] / sum;
            double *restrict a = gathered + row * n, *restrict b = gathered + (2 + 2 * row) * n, *restrict c = b + n;
            MESHONET_INDEPENDENT
            for (ptrdiff_t k = 0; k < n; k++) {
                const double d = share * weight[k];
                a[k] += d, b[k] += d * p[0], c[k] += d * p[1];
            }
        }
    }
}
