/* Multigrid for Winslow's equations by central differences, with the control functions φ and ψ of stencil.h,
       L(x) = α (x_ξξ + φ x_ξ) - 2β x_ξη + γ (x_ηη + ψ x_η) = f,    α = x_η·x_η,  β = x_ξ·x_η,  γ = x_ξ·x_ξ.
   A line of nodes is one tridiagonal matrix with two right sides and a diagonal -(east + west + north + south) < 0. */
#include "multigrid.h"
#include "lines.h"
#include "stencil.h"

/* Doubles that one thread needs. */
static size_t member_room(ptrdiff_t mi, ptrdiff_t mj)
{
    const size_t eta_lines = (size_t)((5 * LANES + 2) * padded(mj));
    const size_t xi_lines = (size_t)(4 * BLOCK * (mi + 1));
    const size_t rows = (size_t)(10 * padded(mj));
    size_t most = eta_lines > xi_lines ? eta_lines : xi_lines;
    return (most > rows ? most : rows) + 64;
}

size_t multigrid_scratch(ptrdiff_t mi, ptrdiff_t mj, int threads)
{
    return (size_t)padded(mi) + (size_t)threads * member_room(mi, mj); /* a sum of each row, then scratch of each thread */
}

/* What a team works on. */
typedef struct {
    const Level *level, *coarse;
    int forced;
} Task;

/* The level with the scratch of one thread; `sized` is the finer level that owns the scratch. */
static Level own_level(const Level *g, const Level *sized, Member member)
{
    Level own = *g;
    own.scratch = sized->scratch + padded(sized->mi) + (size_t)member.rank * member_room(sized->mi, sized->mj);
    return own;
}

/* This thread's of the rows solved for. */
static Range own_rows(const Level *g, Member member)
{
    const ptrdiff_t start = g->periodic ? 0 : 1;
    const Range share = team_share(g->mi - start, member);
    return (Range){share.first + start, share.last + start};
}

static void smooth_share(void *data, Member member)
{
    const Task *task = data;
    const Level own = own_level(task->level, task->level, member);
    eta_lines(&own, member, task->forced);
    xi_lines(&own, member, task->forced);
}

void multigrid_smooth(const Level *level, int forced)
{
    Task task = {level, NULL, forced};
    team_run(level->threads, smooth_share, &task);
}

/* ---- residual, restriction, correction ---- */

MESHONET_INLINE void residual_row_with(const Level *g, ptrdiff_t i, double *restrict rx, double *restrict ry, int mode)
{
    const int forced = mode & FORCED;
    double *restrict phi = g->scratch + 8 * padded(g->mj), *restrict psi = phi + padded(g->mj);
    const Rows r = rows_at(g, i);
    const double forward = g->xi.forward[i], backward = g->xi.backward[i], centred = g->xi.centred[i];
    const Differences eta = g->eta;
    const double *restrict fx = forced ? g->fx + i * (g->mj + 1) : 0;
    const double *restrict fy = forced ? g->fy + i * (g->mj + 1) : 0;
    if (mode & CONTROLLED)
        control_row(g, i, 0, 1, g->mj, phi, psi);
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 1; j < g->mj; j++) {
        const Stencil c = stencil(&r, j, forward, backward, centred, &eta, mode & CONTROLLED ? phi[j] : 0.0,
                                  mode & CONTROLLED ? psi[j] : 0.0, mode);
        const double x = r.xc[j], y = r.yc[j];
        rx[j] = c.cross_x - c.east * (r.xe[j] - x) - c.west * (r.xw[j] - x) - c.north * (r.xc[j + 1] - x) -
                c.south * (r.xc[j - 1] - x) + (forced ? fx[j] : 0.0);
        ry[j] = c.cross_y - c.east * (r.ye[j] - y) - c.west * (r.yw[j] - y) - c.north * (r.yc[j + 1] - y) -
                c.south * (r.yc[j - 1] - y) + (forced ? fy[j] : 0.0);
    }
}

/* rx, ry [1 .. mj-1] = f - L(x) along row i. */
MESHONET_CLONES
static void residual_row(const Level *g, ptrdiff_t i, int forced, double *rx, double *ry)
{
    BY_MODE(mode_of(g, forced), residual_row_with, g, i, rx, ry);
}

MESHONET_INLINE double squares(const double *restrict a, const double *restrict b, ptrdiff_t first, ptrdiff_t last)
{
    double sum = 0.0;
    for (ptrdiff_t j = first; j < last; j++)
        sum += a[j] * a[j] + b[j] * b[j];
    return sum;
}

MESHONET_CLONES
static void residual_rows(const Level *g, ptrdiff_t first, ptrdiff_t last, int forced, double *sums)
{
    double *rx = g->scratch, *ry = rx + padded(g->mj);
    for (ptrdiff_t i = first; i < last; i++) {
        residual_row(g, i, forced, rx, ry);
        sums[i] = squares(rx, ry, 1, g->mj);
    }
}

static void residual_share(void *data, Member member)
{
    const Task *task = data;
    const Level own = own_level(task->level, task->level, member);
    const Range mine = own_rows(&own, member);
    residual_rows(&own, mine.first, mine.last, task->forced, task->level->scratch);
}

double multigrid_residual(const Level *g, int forced)
{
    Task task = {g, NULL, forced};
    double sum = 0.0;
    team_run(g->threads, residual_share, &task);
    for (ptrdiff_t i = g->periodic ? 0 : 1; i < g->mi; i++)
        sum += g->scratch[i];
    return sum;
}

static ptrdiff_t finer(ptrdiff_t coarse, ptrdiff_t last)
{
    return 2 * coarse < last ? 2 * coarse : last;
}

MESHONET_INLINE void inject_row(const Level *fine, const Level *coarse, ptrdiff_t I)
{
    const ptrdiff_t ld = fine->mj + 1, LD = coarse->mj + 1, i = finer(I, fine->mi);
    const double *restrict x = fine->x + i * ld, *restrict y = fine->y + i * ld;
    double *restrict X = coarse->x + I * LD, *restrict Y = coarse->y + I * LD;
    for (ptrdiff_t J = 0; J < coarse->mj; J++)
        X[J] = x[2 * J], Y[J] = y[2 * J];
    X[coarse->mj] = x[fine->mj], Y[coarse->mj] = y[fine->mj];
    memcpy(coarse->x0 + I * LD, X, (size_t)LD * sizeof(double));
    memcpy(coarse->y0 + I * LD, Y, (size_t)LD * sizeof(double));
}

/* ax, ay += weight * residual of the fine row i */
MESHONET_INLINE void add_row(double weight, const double *restrict rx, const double *restrict ry, double *restrict ax,
                             double *restrict ay, ptrdiff_t mj)
{
    for (ptrdiff_t j = 1; j < mj; j++)
        ax[j] += weight * rx[j], ay[j] += weight * ry[j];
}

/* Rows `start` to before `end` of the coarse right side. */
MESHONET_CLONES
static void restrict_residual(const Level *g, const Level *coarse, ptrdiff_t start, ptrdiff_t end, int forced)
{
    const ptrdiff_t width = padded(g->mj), mj = g->mj;
    double *ax = g->scratch, *ay = ax + width, *rx = ay + width, *ry = rx + width;
    double *ox = ry + width, *oy = ox + width; /* the odd row below, shared by two coarse rows */
    const Transfer *along = &g->xi_coarse, across = g->eta_coarse;
    if (start < end && along->before[start] != 0.0)
        residual_row(g, start > 0 ? 2 * start - 1 : g->mi - 1, forced, ox, oy);
    for (ptrdiff_t I = start; I < end; I++) {
        memset(ax, 0, 2 * (size_t)width * sizeof(double));
        if (along->before[I] != 0.0)
            add_row(along->before[I], ox, oy, ax, ay, mj);
        residual_row(g, 2 * I, forced, rx, ry);
        add_row(along->at[I], rx, ry, ax, ay, mj);
        if (along->after[I] != 0.0) {
            residual_row(g, 2 * I + 1, forced, ox, oy);
            add_row(along->after[I], ox, oy, ax, ay, mj);
        }
        double *restrict F = coarse->fx + I * (coarse->mj + 1), *restrict G = coarse->fy + I * (coarse->mj + 1);
        for (ptrdiff_t J = 1; J < coarse->mj; J++) {
            const ptrdiff_t j = 2 * J;
            F[J] = across.before[J] * ax[j - 1] + across.at[J] * ax[j] + across.after[J] * ax[j + 1];
            G[J] = across.before[J] * ay[j - 1] + across.at[J] * ay[j] + across.after[J] * ay[j + 1];
        }
    }
}

/* f += L(x) on the coarse level */
MESHONET_CLONES
static void add_operator(const Level *g, ptrdiff_t first, ptrdiff_t last)
{
    double *rx = g->scratch, *ry = rx + padded(g->mj);
    for (ptrdiff_t i = first; i < last; i++) {
        double *restrict fx = g->fx + i * (g->mj + 1), *restrict fy = g->fy + i * (g->mj + 1);
        residual_row(g, i, 0, rx, ry);
        for (ptrdiff_t j = 1; j < g->mj; j++)
            fx[j] -= rx[j], fy[j] -= ry[j];
    }
}

static void restrict_share(void *data, Member member)
{
    const Task *task = data;
    const Level fine = own_level(task->level, task->level, member), coarse = own_level(task->coarse, task->level, member);
    const Range all = team_share(coarse.mi + 1, member), mine = own_rows(&coarse, member);
    for (ptrdiff_t I = all.first; I < all.last; I++)
        inject_row(&fine, &coarse, I);
    restrict_residual(&fine, &coarse, mine.first, mine.last, task->forced);
    team_wait(member);
    add_operator(&coarse, mine.first, mine.last);
}

void multigrid_restrict(const Level *fine, const Level *coarse, int forced)
{
    Task task = {fine, coarse, forced};
    team_run(fine->threads, restrict_share, &task);
}

/* ex, ey [0 .. MJ] = (1 - w) (X - X0) of row I + w times that of row I + 1 */
MESHONET_INLINE void difference_row(const Level *coarse, ptrdiff_t I, double w, double *restrict ex, double *restrict ey)
{
    const ptrdiff_t LD = coarse->mj + 1, a = I * LD, b = w != 0.0 ? a + LD : a;
    const double *restrict X = coarse->x, *restrict Y = coarse->y, *restrict X0 = coarse->x0, *restrict Y0 = coarse->y0;
    for (ptrdiff_t J = 0; J < LD; J++) {
        ex[J] = (1.0 - w) * (X[a + J] - X0[a + J]) + w * (X[b + J] - X0[b + J]);
        ey[J] = (1.0 - w) * (Y[a + J] - Y0[a + J]) + w * (Y[b + J] - Y0[b + J]);
    }
}

/* Rows `first` to before `last`; sums of the coarse ones among them. */
MESHONET_CLONES
static void correct_rows(const Level *fine, const Level *coarse, ptrdiff_t first, ptrdiff_t last, double *sums)
{
    const ptrdiff_t mj = fine->mj, ld = mj + 1;
    const double *restrict right = fine->eta_coarse.right;
    double *restrict ex = fine->scratch, *restrict ey = ex + padded(mj);
    for (ptrdiff_t i = first; i < last; i++) {
        double *restrict x = fine->x + i * ld, *restrict y = fine->y + i * ld;
        difference_row(coarse, i / 2, i % 2 ? fine->xi_coarse.right[i] : 0.0, ex, ey);
        if (i % 2 == 0)
            sums[i / 2] = squares(ex, ey, 1, coarse->mj);
        x[1] += (1.0 - right[1]) * ex[0] + right[1] * ex[1];
        y[1] += (1.0 - right[1]) * ey[0] + right[1] * ey[1];
        for (ptrdiff_t J = 1; 2 * J + 1 < mj; J++) {
            const double w = right[2 * J + 1];
            x[2 * J] += ex[J];
            y[2 * J] += ey[J];
            x[2 * J + 1] += (1.0 - w) * ex[J] + w * ex[J + 1];
            y[2 * J + 1] += (1.0 - w) * ey[J] + w * ey[J + 1];
        }
        if (mj % 2) { /* the last interior node is a coarse node of its own */
            x[mj - 1] += ex[mj / 2];
            y[mj - 1] += ey[mj / 2];
        }
    }
}

static void correct_share(void *data, Member member)
{
    const Task *task = data;
    const Level fine = own_level(task->level, task->level, member);
    const Range mine = own_rows(&fine, member);
    correct_rows(&fine, task->coarse, mine.first, mine.last, task->level->scratch);
}

double multigrid_correct(const Level *fine, const Level *coarse)
{
    Task task = {fine, coarse, 0};
    double sum = 0.0;
    team_run(fine->threads, correct_share, &task);
    if (fine->periodic)
        close_ring(fine);
    for (ptrdiff_t i = fine->periodic ? 0 : 2; i < fine->mi; i += 2)
        sum += fine->scratch[i / 2];
    return sum;
}
