#include "row.h"
#include "team.h"

#define BLOCK 128 /* cells of a row at a time */

/* Cells of a row of which a corner Jacobian is not positive, or not a number. */
MESHONET_CLONES
static ptrdiff_t corners_not_positive(const SolidLines *lines, ptrdiff_t cells)
{
    const SolidLines own = *lines;
    int64_t good = 0;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < cells; k++) {
        const SolidEdges e = solid_edges(&own, k);
        int64_t all = 1;
        for (int a = 0; a < 2; a++)
            for (int b = 0; b < 2; b++)
                for (int c = 0; c < 2; c++)
                    all &= triple(e.u[b][c], e.v[a][c], e.w[a][b]) > 0;
        good += all;
    }
    return cells - (ptrdiff_t)good;
}

/* Cells of a row of which a Bezier coefficient is not positive. */
MESHONET_CLONES
static ptrdiff_t bezier_not_positive(const SolidLines *lines, ptrdiff_t cells)
{
    const SolidLines own = *lines;
    int64_t good = 0;
    double least[BLOCK];
    for (ptrdiff_t start = 0; start < cells; start += BLOCK) {
        const ptrdiff_t count = cells - start < BLOCK ? cells - start : BLOCK;
        MESHONET_INDEPENDENT
        for (ptrdiff_t m = 0; m < count; m++) {
            const SolidEdges e = solid_edges(&own, start + m);
            least[m] = bezier_least(&e, 0);
        }
        MESHONET_INDEPENDENT
        for (ptrdiff_t m = 0; m < count; m++) {
            const SolidEdges e = solid_edges(&own, start + m);
            least[m] = smaller(least[m], bezier_least(&e, 1));
        }
        MESHONET_INDEPENDENT
        for (ptrdiff_t m = 0; m < count; m++) {
            const SolidEdges e = solid_edges(&own, start + m);
            good += smaller(least[m], bezier_least(&e, 2)) > 0;
        }
    }
    return cells - (ptrdiff_t)good;
}

static int is_point(Vector edge) { return edge.x == 0 && edge.y == 0 && edge.z == 0; }

/* Whether cell k of a row fails the test, without corners at edges of no length if others are left. */
static int fails(const SolidLines *lines, ptrdiff_t k, int test)
{
    const SolidEdges e = solid_edges(lines, k);
    int left = 0, collapsed = 0;
    double most = 0, least = 1e300;
    for (int corner = 0; corner < 8; corner++) {
        const int a = corner >> 2, b = corner >> 1 & 1, c = corner & 1;
        if (is_point(e.u[b][c]) || is_point(e.v[a][c]) || is_point(e.w[a][b])) {
            collapsed = 1;
            continue;
        }
        const double jacobian = triple(e.u[b][c], e.v[a][c], e.w[a][b]);
        if (!(jacobian > 0))
            return 1;
        most = larger(most, jacobian);
        left = 1;
    }
    if (!left || test == SOLID_CORNERS)
        return !left;
    for (int p = 0; p < 3; p++)
        least = smaller(least, bezier_least(&e, p));
    return collapsed ? !(least > -1e-12 * most) : !(least > 0); /* where it is collapsed a Jacobian is 0 */
}

static ptrdiff_t fails_in_row(const SolidLines *lines, ptrdiff_t cells, int test)
{
    ptrdiff_t count = test == SOLID_CORNERS ? corners_not_positive(lines, cells) : bezier_not_positive(lines, cells);
    if (!count)
        return 0;
    count = 0;
    for (ptrdiff_t k = 0; k < cells; k++)
        count += fails(lines, k, test);
    return count;
}

typedef struct {
    const SolidNodes *nodes;
    int test;
    int64_t *counts;
} Count;

static void count_rows(void *data, Member member)
{
    const Count *count = data;
    const ptrdiff_t nj = count->nodes->nj - 1;
    const Range mine = team_share((count->nodes->ni - 1) * nj, member);
    for (ptrdiff_t row = mine.first; row < mine.last; row++) {
        const SolidLines lines = solid_lines(count->nodes, row / nj, row % nj);
        count->counts[row] = fails_in_row(&lines, count->nodes->nk - 1, count->test);
    }
}

void solids_folded(const SolidNodes *nodes, int test, int threads, int64_t *counts)
{
    Count count = {nodes, test, counts};
    team_run(threads, count_rows, &count);
}

void solids_places(const SolidNodes *nodes, int test, const int64_t *counts, int64_t *places)
{
    const ptrdiff_t nj = nodes->nj - 1;
    for (ptrdiff_t row = 0; row < (nodes->ni - 1) * nj; row++) {
        const SolidLines lines = solid_lines(nodes, row / nj, row % nj);
        for (ptrdiff_t k = 0; counts[row] && k < nodes->nk - 1; k++)
            if (fails(&lines, k, test)) {
                *places++ = row / nj;
                *places++ = row % nj;
                *places++ = k;
            }
    }
}
