/* Descent of the variational functional: L-BFGS (steps.c) with a preconditioner (frame.h); the functional's gradient
   over a grid from its rows of cells (functional.h), and its Hessian on a coarse one. */
#include "variational.h"
#include "frame.h"
#include "functional.h"
#include "hessian.h"
#include "team.h"

#define TRIES 25  /* lengths of a step of Newton's method that are tried */
#define GAIN 1e-4 /* part of the value that such a change wins at the most */

#define ROWS_EACH 14 /* rows of a member of the team: ten of cells, two pairs of gradients */

size_t variational_workspace(ptrdiff_t ni, ptrdiff_t nj, int threads)
{
    return (size_t)(2 * ni * nj + 6 * ni) + (size_t)threads * (size_t)(ROWS_EACH * nj);
}

/* What a team works on. */
typedef struct {
    const double *x, *y;
    ptrdiff_t ni, nj;
    double *gx, *gy;
    Factors at_corner, at_centre;
    Family along, across; /* edges along xi and along eta, in the same room */
    int regular;
    double *cells, *least, *lengths, *spare; /* of each row, (ni); twice that in spare */
    double *rows;
} Task;

/* Terms of rows `first` to before `last`, of cells or of edges, to the gradient of the nodes from row `first` on, and
   the energy and the smallest Jacobian of each row. */
typedef void (*Terms)(const Task *t, ptrdiff_t first, ptrdiff_t last, double *gx, double *gy, double *energies,
                      double *least, double *rows);

MESHONET_CLONES
static void corner_terms(const Task *t, ptrdiff_t first, ptrdiff_t last, double *gx, double *gy, double *energies,
                         double *least, double *rows)
{
    const ptrdiff_t nj = t->nj;
    const Factors at_corner = t->at_corner, at_centre = t->at_centre;
    const CellRow r = {rows,          rows + nj,     rows + 2 * nj, rows + 3 * nj, rows + 4 * nj,
                       rows + 5 * nj, rows + 6 * nj, rows + 7 * nj, rows + 8 * nj, rows + 9 * nj};
    for (ptrdiff_t i = first; i < last; i++, gx += nj, gy += nj) {
        const double *xa = t->x + i * nj, *ya = t->y + i * nj;
        double low = INFINITY;
        if (t->regular)
            energies[i] = cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &at_corner, &at_centre, 1, &r);
        else
            energies[i] = cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &at_corner, &at_centre, 0, &r);
        for (ptrdiff_t j = 0; j < nj - 1; j++)
            low = r.least[j] < low ? r.least[j] : low;
        least[i] = low;
        scatter(r.sx, r.nx, r.wx, r.ex, gx, gx + nj, nj - 1);
        scatter(r.sy, r.ny, r.wy, r.ey, gy, gy + nj, nj - 1);
    }
}

MESHONET_CLONES
static void along_terms(const Task *t, ptrdiff_t first, ptrdiff_t last, double *gx, double *gy, double *energies,
                        double *least, double *rows)
{
    (void)least;
    length_rows(t->x, t->y, &t->along, 2, first, last, gx, gy, energies, rows);
}

MESHONET_CLONES
static void across_terms(const Task *t, ptrdiff_t first, ptrdiff_t last, double *gx, double *gy, double *energies,
                         double *rows)
{
    length_rows(t->x, t->y, &t->across, 1, first, last, gx, gy, energies, rows);
}

/* Terms of rows between two rows of nodes, to the nodes in rows `first` to before `last`, which are this member's. Rows
   between two members' nodes are looked at by both, for the sake of their own. */
static void to_own_nodes(const Task *t, Terms terms, ptrdiff_t first, ptrdiff_t last, double *energies, double *rows)
{
    const ptrdiff_t nj = t->nj;
    const size_t line = (size_t)nj * sizeof(double);
    double *px = rows + 10 * nj, *py = px + 2 * nj, *least = t->least; /* pairs of rows */
    double *spare = t->spare, *spare_least = spare + t->ni;
    if (first > 0 && first < last) {
        memset(px, 0, 4 * line);
        terms(t, first - 1, first, px, py, spare, spare_least, rows);
        for (ptrdiff_t j = 0; j < nj; j++)
            t->gx[first * nj + j] += px[nj + j], t->gy[first * nj + j] += py[nj + j];
    }
    const ptrdiff_t whole = last < t->ni ? last - 1 : last == t->ni && first < last ? t->ni - 1 : first;
    if (first < whole)
        terms(t, first, whole, t->gx + first * nj, t->gy + first * nj, energies, least, rows);
    if (first < last && last < t->ni) {
        memcpy(px, t->gx + whole * nj, line), memcpy(py, t->gy + whole * nj, line);
        memset(px + nj, 0, line), memset(py + nj, 0, line);
        terms(t, whole, last, px, py, energies, least, rows);
        memcpy(t->gx + whole * nj, px, line), memcpy(t->gy + whole * nj, py, line);
    }
}

static double *member_rows(const Task *t, Member member)
{
    return t->rows + (size_t)member.rank * (size_t)(ROWS_EACH * t->nj);
}

static void corner_share(void *data, Member member)
{
    const Task *t = data;
    const Range mine = team_share(t->ni, member);
    memset(t->gx + mine.first * t->nj, 0, (size_t)((mine.last - mine.first) * t->nj) * sizeof *t->gx);
    memset(t->gy + mine.first * t->nj, 0, (size_t)((mine.last - mine.first) * t->nj) * sizeof *t->gy);
    to_own_nodes(t, corner_terms, mine.first, mine.last, t->cells, member_rows(t, member));
}

MESHONET_CLONES
static void measure_rows(const Task *t, const Family *f, ptrdiff_t first, ptrdiff_t last)
{
    for (ptrdiff_t i = first; i < last && i < f->rows; i++)
        measure_row(t->x + i * t->nj, t->y + i * t->nj, f->next, f->n, f->length + i * f->n, f->inverse + i * f->n);
}

static void along_share(void *data, Member member)
{
    const Task *t = data;
    const Range mine = team_share(t->ni, member);
    measure_rows(t, &t->along, mine.first, mine.last);
    team_wait(member);
    to_own_nodes(t, along_terms, mine.first, mine.last, t->lengths, member_rows(t, member));
}

static void across_share(void *data, Member member)
{
    const Task *t = data;
    const ptrdiff_t nj = t->nj;
    const Range mine = team_share(t->ni, member);
    measure_rows(t, &t->across, mine.first, mine.last);
    team_wait(member);
    across_terms(t, mine.first, mine.last, t->gx + mine.first * nj, t->gy + mine.first * nj, t->lengths, member_rows(t, member));
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
        eps > 0.0, sums, sums + ni, sums + 2 * ni, sums + 3 * ni, sums + 6 * ni,
    };
    team_run(threads, corner_share, &t);
    double energy = sum_of(t.cells, ni - 1);
    for (ptrdiff_t i = 0; i < ni - 1; i++)
        low = t.least[i] < low ? t.least[i] : low;
    *smallest = low;
    if (!(eps > 0.0) && !(low > 0.0))
        return INFINITY;
    if (weights->smoothness > 0.0) {
        team_run(threads, along_share, &t);
        energy += sum_of(t.lengths, ni - 1);
        team_run(threads, across_share, &t);
        energy += sum_of(t.lengths, ni);
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
static void move_rows(const Try *t, ptrdiff_t first, ptrdiff_t last)
{
    const Descent *d = t->d;
    const double factor = t->factor;
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

TEAM_ROWS(move_share, Try, task->d->ni, move_rows)

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
static void fresh_rows(const Descent *d, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t nodes = d->ni * d->nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    const double *g = d->full + 2 * nodes;
    for (int c = 0; c < 2; c++)
        for (ptrdiff_t i = first; i < last; i++)
            memcpy(d->steps.fresh + (c * mi + i) * mj, g + c * nodes + (d->first + i) * d->nj + 1,
                   (size_t)mj * sizeof *g);
}

TEAM_ROWS(fresh_share, Descent, task->spectrum.mi, fresh_rows)

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

static void keep_values(const Descent *d, ptrdiff_t first, ptrdiff_t last)
{
    memcpy(d->z + first, d->full + first, (size_t)(last - first) * sizeof *d->z);
}

TEAM_ROWS(keep_share, Descent, 2 * task->ni * task->nj, keep_values)

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
    team_run(d->threads, frame_share, d);
    steps_start(s);
}

double descent_slope(const Descent *d)
{
    double total = 0.0;
    for (ptrdiff_t k = 0; k < d->steps.n; k++)
        total += d->steps.gradient[k] * d->steps.gradient[k];
    return sqrt(total);
}
