#include <string.h>

#include "geometry/tally.h"
#include "row.h"
#include "team.h"

#define LARGE 1e30 /* growth beside a step of no length */

/* Growth and bend of grid lines at nodes `at`, between those `before` and `after` them. */
MESHONET_CLONES
static void at_nodes(const double *const before[3], const double *const at[3], const double *const after[3],
                     ptrdiff_t count, double *restrict growth, double *restrict bend)
{
    const double *ax = before[0], *ay = before[1], *az = before[2], *bx = at[0], *by = at[1], *bz = at[2];
    const double *cx = after[0], *cy = after[1], *cz = after[2];
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < count; k++) {
        const Vector u = {bx[k] - ax[k], by[k] - ay[k], bz[k] - az[k]}, v = {cx[k] - bx[k], cy[k] - by[k], cz[k] - bz[k]};
        const double first = __builtin_sqrt(dot(u, u)), second = __builtin_sqrt(dot(v, v));
        const double high = larger(first, second), low = smaller(first, second), product = first * second;
        const double ratio = smaller(high / larger(low, 1e-300), LARGE);
        growth[k] = high > 0 ? ratio : 1.0; /* a line that is a point, at a pole */
        bend[k] = product > 0 ? dot(u, v) / larger(product, 1e-300) : 1.0;
    }
    for (ptrdiff_t k = 0; k < count; k++)
        bend[k] = angle(bend[k]);
}

typedef struct {
    const SolidNodes *nodes;
    double *summary;
    int64_t *where;
    float *values; /* or none */
} Lines;

/* Take `count` values from (i, j, k) on into measure `m` of a plane. */
static void take(const Lines *lines, ptrdiff_t m, const double *row, ptrdiff_t count, const ptrdiff_t at[3])
{
    double low, high, sum, *summary = lines->summary + 2 * (at[0] * 6 + m);
    int64_t *where = lines->where + 3 * (at[0] * 6 + m);
    if (count < 1)
        return;
    values_reduce(row, count, &low, &high, &sum);
    if (lines->values) {
        const ptrdiff_t nj = lines->nodes->nj, nk = lines->nodes->nk;
        float *to = lines->values + ((m * lines->nodes->ni + at[0]) * nj + at[1]) * nk + at[2];
        for (ptrdiff_t k = 0; k < count; k++)
            to[k] = (float)row[k];
    }
    summary[1] += sum;
    if (high <= summary[0])
        return;
    summary[0] = high;
    where[0] = at[0];
    where[1] = at[1];
    where[2] = at[2] + value_place(row, count, high);
}

static void of_planes(void *data, Member member)
{
    const Lines *lines = data;
    const SolidNodes *nodes = lines->nodes;
    const ptrdiff_t steps[3] = {nodes->nj * nodes->nk, nodes->nk, 1};
    double *growth = team_room(member), *bend = growth + nodes->nk;
    const Range mine = team_share(nodes->ni, member);
    for (ptrdiff_t i = mine.first; i < mine.last; i++)
        for (ptrdiff_t j = 0; j < nodes->nj; j++)
            for (int axis = 0; axis < 3; axis++) {
                if ((axis == 0 && (i == 0 || i == nodes->ni - 1)) || (axis == 1 && (j == 0 || j == nodes->nj - 1)))
                    continue;
                const ptrdiff_t from[3] = {i, j, axis == 2};
                const double *before[3], *at[3], *after[3];
                for (int d = 0; d < 3; d++) {
                    at[d] = nodes->at[d] + i * steps[0] + j * steps[1] + from[2];
                    before[d] = at[d] - steps[axis];
                    after[d] = at[d] + steps[axis];
                }
                const ptrdiff_t count = axis == 2 ? nodes->nk - 2 : nodes->nk;
                at_nodes(before, at, after, count, growth, bend);
                take(lines, 2 * axis, growth, count, from);
                take(lines, 2 * axis + 1, bend, count, from);
            }
}

int solids_lines(const SolidNodes *nodes, int threads, double *summary, int64_t *where, float *values)
{
    Lines lines = {nodes, summary, where, values};
    for (ptrdiff_t k = 0; k < nodes->ni * 6; k++) {
        summary[2 * k] = -1;
        summary[2 * k + 1] = 0;
    }
    memset(where, 0, (size_t)nodes->ni * 18 * sizeof(int64_t));
    return team_run_in_rooms(threads, 2 * (size_t)nodes->nk, of_planes, &lines) == 0;
}
