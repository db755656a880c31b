/* Descent of the variational functional: L-BFGS (steps.c) with a preconditioner (frame.h); the functional's gradient
   over a grid from its rows of cells (functional.h), and its Hessian on a coarse one. */
#include "variational.h"
#include "frame.h"
#include "functional.h"
#include "hessian.h"
#include "team.h"

#define TRIES 25  /* lengths of a step of Newton's method that are tried */
#define GAIN 1e-4 /* part of the value that such a change wins at the most */

#define ROWS_EACH 10 /* rows of a member of the team: nine of forces, and one for what is another's */

size_t variational_workspace(ptrdiff_t ni, ptrdiff_t nj, int threads)
{
    return (size_t)(2 * ni * nj + 4 * ni) + (size_t)threads * (size_t)(ROWS_EACH * nj);
}

/* What a team works on. Members have rows of nodes of their own: the cells, or edges, between those of two members
   are looked at by both. */
typedef struct {
    const double *x, *y;
    ptrdiff_t ni, nj;
    double *gx, *gy;
    Factors at_corner, at_centre;
    Family along, across; /* edges along xi and along eta, in the same room */
    int regular;
    double *cells, *least, *lengths[2]; /* of each row */
    double *rows;
} Task;

static double *member_rows(const Task *t, Member member)
{
    return t->rows + (size_t)member.rank * (size_t)(ROWS_EACH * t->nj);
}

/* Terms of the corners and centres of cells, to nodes in rows `first` to before `last`. */
MESHONET_CLONES
static void corner_rows(const Task *t, ptrdiff_t first, ptrdiff_t last, double *rows)
{
    const ptrdiff_t nj = t->nj, end = last < t->ni ? last : t->ni - 1;
    double *lost = rows + 9 * nj;
    const CellRow r = {rows,          rows + nj,     rows + 2 * nj, rows + 3 * nj, rows + 4 * nj,
                       rows + 5 * nj, rows + 6 * nj, rows + 7 * nj, rows + 8 * nj};
    memset(lost, 0, (size_t)nj * sizeof *lost);
    if (first < last) {
        memset(t->gx + first * nj, 0, (size_t)((last - first) * nj) * sizeof *t->gx);
        memset(t->gy + first * nj, 0, (size_t)((last - first) * nj) * sizeof *t->gy);
    }
    for (ptrdiff_t i = first > 0 && first < last ? first - 1 : first; i < end; i++) {
        const double *xa = t->x + i * nj, *ya = t->y + i * nj;
        const int own = i >= first, next = i + 1 < last;
        double energy, low = INFINITY;
        if (t->regular)
            energy = cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &t->at_corner, &t->at_centre, 1, &r);
        else
            energy = cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &t->at_corner, &t->at_centre, 0, &r);
        for (ptrdiff_t j = 0; j < nj - 1; j++)
            low = r.least[j] < low ? r.least[j] : low;
        if (own)
            t->cells[i] = energy, t->least[i] = low;
        scatter(r.sx, r.nx, r.wx, r.ex, own ? t->gx + i * nj : lost, next ? t->gx + (i + 1) * nj : lost, nj - 1);
        scatter(r.sy, r.ny, r.wy, r.ey, own ? t->gy + i * nj : lost, next ? t->gy + (i + 1) * nj : lost, nj - 1);
    }
}

static void corner_share(void *data, Member member)
{
    const Task *t = data;
    ptrdiff_t first, last;
    team_share(t->ni, member, &first, &last);
    corner_rows(t, first, last, member_rows(t, member));
}

MESHONET_CLONES
static void measure_rows(const Task *t, const Family *f, ptrdiff_t first, ptrdiff_t last)
{
    for (ptrdiff_t i = first; i < last && i < f->rows; i++)
        measure_row(t->x + i * t->nj, t->y + i * t->nj, f->next, f->n, f->length + i * f->n, f->inverse + i * f->n);
}

/* Edges along xi, to nodes in rows `first` to before `last`. */
MESHONET_CLONES
static void along_rows_of(const Task *t, ptrdiff_t first, ptrdiff_t last, double *rows)
{
    const Family *f = &t->along;
    const ptrdiff_t nj = t->nj;
    double *lost = rows + 9 * nj;
    for (ptrdiff_t i = first > 0 && first < last ? first - 1 : first; i < last && i < f->rows; i++) {
        const int own = i >= first, next = i + 1 < last;
        const double energy = length_row(f, i, rows);
        double *gx = t->gx + i * nj, *gy = t->gy + i * nj;
        if (own)
            t->lengths[0][i] = energy;
        push_row(t->x + i * nj, t->y + i * nj, f->next, f->n, rows, f->inverse + i * f->n, own ? gx : lost,
                 own ? gy : lost, next ? gx + nj : lost, next ? gy + nj : lost);
    }
}

MESHONET_CLONES
static void across_rows(const Task *t, ptrdiff_t first, ptrdiff_t last, double *rows)
{
    const Family *f = &t->across;
    const ptrdiff_t nj = t->nj;
    for (ptrdiff_t i = first; i < last; i++) {
        double *gx = t->gx + i * nj, *gy = t->gy + i * nj;
        t->lengths[1][i] = length_row(f, i, rows);
        push_row(t->x + i * nj, t->y + i * nj, f->next, f->n, rows, f->inverse + i * f->n, gx, gy, gx + 1, gy + 1);
    }
}

static void length_share(void *data, Member member)
{
    const Task *t = data;
    double *rows = member_rows(t, member);
    ptrdiff_t first, last;
    team_share(t->ni, member, &first, &last);
    measure_rows(t, &t->along, first, last);
    team_wait(member);
    along_rows_of(t, first, last, rows);
    team_wait(member);
    measure_rows(t, &t->across, first, last);
    team_wait(member);
    across_rows(t, first, last, rows);
}

/* The sum of n values, one after another; volatile, or the compiler would take several at a time. */
static double in_order(const double *values, ptrdiff_t n)
{
    volatile double sum = 0.0;
    for (ptrdiff_t k = 0; k < n; k++)
        sum += values[k];
    return sum;
}

double variational_energy(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const Weights *weights,
                          int threads, double *gx, double *gy, double *smallest, double *work)
{
    const double cells = (double)(ni - 1) * (double)(nj - 1), eps = weights->epsilon;
    const double one = 1.0 / (12.0 * cells), two = 8.0 * one, rest = 0.5 * (1.0 - weights->shape);
    const double along = rest * weights->aspect, across = rest / weights->aspect;
    const double by_i = weights->smoothness / cells * (double)((ni - 1) * (ni - 1));
    const double by_j = weights->smoothness / cells * (double)((nj - 1) * (nj - 1));
    double *sums = work + 2 * ni * nj, low = INFINITY;
    Task t = {
        x, y, ni, nj, gx, gy,
        {one * along, one * across, one * weights->shape, eps * eps},
        {two * along, two * across, two * weights->shape, 16.0 * eps * eps},
        {nj, ni - 1, nj, nj, weights->periodic, by_i, by_j, work, work + ni * nj},
        {nj, ni, nj - 1, 1, weights->periodic, by_i, by_j, work, work + ni * nj},
        eps > 0.0, sums, sums + ni, {sums + 2 * ni, sums + 3 * ni}, sums + 4 * ni,
    };
    team_run(threads, corner_share, &t);
    double energy = in_order(t.cells, ni - 1);
    for (ptrdiff_t i = 0; i < ni - 1; i++)
        low = t.least[i] < low ? t.least[i] : low;
    *smallest = low;
    if (!(eps > 0.0) && !(low > 0.0))
        return INFINITY;
    if (weights->smoothness > 0.0) {
        team_run(threads, length_share, &t);
        energy += in_order(t.lengths[0], ni - 1);
        energy += in_order(t.lengths[1], ni);
    }
    if (weights->relief && !(eps > 0.0))
        energy -= relieve(x, y, ni, nj, weights, one * weights->shape, gx, gy);
    clear_rim(gx, ni, nj, weights->periodic);
    clear_rim(gy, ni, nj, weights->periodic);
    return isfinite(energy) ? energy : INFINITY;
}

/* Of a number of the unknowns, the place in planes of nodes. */
MESHONET_INLINE ptrdiff_t place_of(const Band *b, ptrdiff_t k)
{
    const ptrdiff_t node = k / 2, nj = b->mj + 2;
    return k % 2 * (b->mi + 2) * nj + (node / b->mj + 1) * nj + node % b->mj + 1;
}

size_t band_floats(Band *b, ptrdiff_t mi, ptrdiff_t mj)
{
    b->mi = mi, b->mj = mj, b->width = 4 * mj + 1, b->stride = b->width + TOGETHER + LANES;
    return (size_t)(2 * mi * mj * b->stride);
}

int band_factor(const Band *b, const double *z, const Weights *weights, double *unit)
{
    const ptrdiff_t nj = b->mj + 2, nodes = (b->mi + 2) * nj;
    double squares = 0.0; /* of steps along eta */
    for (ptrdiff_t k = 1; k < nodes; k++) {
        const double dx = z[k] - z[k - 1], dy = z[nodes + k] - z[nodes + k - 1];
        squares += k % nj ? dx * dx + dy * dy : 0.0;
    }
    *unit = squares / (double)nodes;
    for (int k = 0; k < 3; k++) {
        hessian(z, z + nodes, weights, *unit, 1.0 - 0.5 * k, b);
        if (factorise(b))
            return 1;
    }
    return 0;
}

static int newton_step(const Band *b, double *z, const Weights *weights, double *value, double *g, double *room, float *moves)
{
    const ptrdiff_t ni = b->mi + 2, nj = b->mj + 2, nodes = ni * nj, n = 2 * b->mi * b->mj;
    double *at = room, *fresh = room + 2 * nodes, *work = room + 4 * nodes, unit, slope = 0.0, factor = 1.0, low;
    if (!isfinite(*value) || !band_factor(b, z, weights, &unit))
        return 0;
    for (ptrdiff_t k = 0; k < n; k++)
        moves[k] = (float)(-unit * g[place_of(b, k)]);
    solve_band(b, moves);
    for (ptrdiff_t k = 0; k < n; k++)
        slope += (double)moves[k] * g[place_of(b, k)];
    for (int tries = 0; slope < 0.0 && tries < TRIES; tries++) {
        memcpy(at, z, 2 * (size_t)nodes * sizeof *z);
        for (ptrdiff_t k = 0; k < n; k++)
            at[place_of(b, k)] += factor * (double)moves[k];
        const double found = variational_energy(at, at + nodes, ni, nj, weights, 1, fresh, fresh + nodes, &low, work);
        if (found <= *value + 1e-4 * factor * slope) {
            *value = found;
            memcpy(z, at, 2 * (size_t)nodes * sizeof *z);
            memcpy(g, fresh, 2 * (size_t)nodes * sizeof *g);
            return 1;
        }
        factor *= shorter(found - *value, factor * slope);
    }
    return 0;
}

int newton_steps(const Band *b, double *z, const Weights *weights, int most, double won, double *room, float *moves)
{
    const ptrdiff_t ni = b->mi + 2, nj = b->mj + 2, nodes = ni * nj;
    double low, value = variational_energy(z, z + nodes, ni, nj, weights, 1, room, room + nodes, &low, room + 6 * nodes);
    double before = value;
    int done = 0;
    while (done < most && newton_step(b, z, weights, &value, room, room + 2 * nodes, moves)) {
        done++;
        if (before - value < won * before)
            break;
        before = value;
    }
    return done;
}

void descent_sizes(const Descent *d, size_t *doubles, size_t *floats)
{
    const Spectrum *s = &d->spectrum;
    const ptrdiff_t nodes = values_of(&s->eta), modes = modes_of(&s->eta), free_nodes = s->mi * s->mj;
    const size_t widest = (size_t)(nodes > modes ? nodes : modes);
    *doubles = 4 * (size_t)(d->ni * d->nj) + variational_workspace(d->ni, d->nj, d->threads) + 4 * (size_t)free_nodes;
    *floats = 2 * (size_t)free_nodes + steps_floats(2 * free_nodes) + 6 * (size_t)s->mi * widest +
              (size_t)d->threads * (size_t)member_floats(s) + (size_t)(SPACE * SPACE * space_blocks(s->mi));
}

void descent_place(Descent *d, double *doubles, float *floats)
{
    const ptrdiff_t nodes = d->ni * d->nj, n = 2 * d->spectrum.mi * d->spectrum.mj;
    d->full = doubles, d->work = d->full + 4 * nodes;
    double *gradient = d->work + variational_workspace(d->ni, d->nj, d->threads);
    d->frame = floats;
    steps_place(&d->steps, n, gradient, gradient + n, floats + n);
    d->steps.threads = d->threads;
    d->transform = floats + n + steps_floats(n);
}

/* A step that a team tries. */
typedef struct {
    const Descent *d;
    double factor;
} Try;

/* Rows `first` to before `last` of planes of z, moved by `factor` directions. */
MESHONET_CLONES
static void move_rows(const Descent *d, double factor, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t nj = d->nj, nodes = d->ni * nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    for (int c = 0; c < 2 && first < last; c++) {
        double *to = d->full + c * nodes;
        memcpy(to + first * nj, d->z + c * nodes + first * nj, (size_t)((last - first) * nj) * sizeof *to);
        for (ptrdiff_t i = first; i < last; i++) {
            const ptrdiff_t k = i - d->first;
            if (k < 0 || k >= mi)
                continue;
            const float *restrict step = d->steps.direction + (c * mi + k) * mj;
            double *restrict row = to + i * nj + 1;
            for (ptrdiff_t j = 0; j < mj; j++)
                row[j] += factor * (double)step[j];
        }
    }
}

static void move_share(void *data, Member member)
{
    const Try *t = data;
    ptrdiff_t first, last;
    team_share(t->d->ni, member, &first, &last);
    move_rows(t->d, t->factor, first, last);
}

/* Planes of z moved by `factor` directions. */
static void move(const Descent *d, double factor)
{
    const ptrdiff_t nj = d->nj, last = (d->ni - 1) * nj;
    Try t = {d, factor};
    team_run(d->threads, move_share, &t);
    for (int c = 0; c < 2 && d->weights.periodic; c++) {
        double *to = d->full + c * d->ni * nj;
        memcpy(to + last, to, (size_t)nj * sizeof *to);
    }
}

/* The gradient at free nodes. */
static void fresh_share(void *data, Member member)
{
    const Descent *d = data;
    const ptrdiff_t nodes = d->ni * d->nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    const double *g = d->full + 2 * nodes;
    ptrdiff_t first, last;
    team_share(mi, member, &first, &last);
    for (int c = 0; c < 2; c++)
        for (ptrdiff_t i = first; i < last; i++)
            memcpy(d->steps.fresh + (c * mi + i) * mj, g + c * nodes + (d->first + i) * d->nj + 1,
                   (size_t)mj * sizeof *g);
}

static double attempt(void *problem, double factor, double *smallest)
{
    Descent *d = problem;
    const ptrdiff_t nodes = d->ni * d->nj;
    const double *at = factor > 0.0 ? d->full : d->z;
    double *g = d->full + 2 * nodes;
    if (factor > 0.0)
        move(d, factor);
    const double value =
        variational_energy(at, at + nodes, d->ni, d->nj, &d->weights, d->threads, g, g + nodes, smallest, d->work);
    team_run(d->threads, fresh_share, d);
    return value;
}

static void keep_share(void *data, Member member)
{
    const Descent *d = data;
    ptrdiff_t first, last;
    team_share(2 * d->ni * d->nj, member, &first, &last);
    memcpy(d->z + first, d->full + first, (size_t)(last - first) * sizeof *d->z);
}

static void keep(void *problem)
{
    const Descent *d = problem;
    team_run(d->threads, keep_share, problem);
}

void descent_start(Descent *d)
{
    Steps *s = &d->steps;
    s->problem = d, s->attempt = attempt, s->keep = keep, s->precondition = precondition;
    s->largest_move = largest_move, s->farthest = INFINITY, s->gain = GAIN;
    set_frame(d);
    steps_start(s);
}

double descent_slope(const Descent *d)
{
    double total = 0.0;
    for (ptrdiff_t k = 0; k < d->steps.n; k++)
        total += d->steps.gradient[k] * d->steps.gradient[k];
    return sqrt(total);
}
