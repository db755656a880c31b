/* Descent of the variational functional: L-BFGS (steps.c) with a preconditioner (frame.h); the functional's gradient
   over a grid from its rows of cells (functional.h), and its Hessian on a coarse one. */
#include "variational.h"
#include "frame.h"
#include "functional.h"
#include "hessian.h"

#define TRIES 25  /* lengths of a step of Newton's method that are tried */
#define GAIN 1e-4 /* part of the value that such a change wins at the most */

size_t variational_workspace(ptrdiff_t ni, ptrdiff_t nj)
{
    return (size_t)(2 * ni * nj + 9 * nj);
}

MESHONET_CLONES
double variational_energy(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const Weights *weights,
                          double *gx, double *gy, double *smallest, double *work)
{
    const double cells = (double)(ni - 1) * (double)(nj - 1), eps = weights->epsilon;
    const double one = 1.0 / (12.0 * cells), two = 8.0 * one, rest = 0.5 * (1.0 - weights->shape);
    const double along = rest * weights->aspect, across = rest / weights->aspect;
    const Factors at_corner = {one * along, one * across, one * weights->shape, eps * eps};
    const Factors at_centre = {two * along, two * across, two * weights->shape, 16.0 * eps * eps};
    double *rows = work + 2 * ni * nj;
    const CellRow r = {rows,          rows + nj,     rows + 2 * nj, rows + 3 * nj, rows + 4 * nj,
                       rows + 5 * nj, rows + 6 * nj, rows + 7 * nj, rows + 8 * nj};
    double energy = 0.0, low = INFINITY;
    memset(gx, 0, (size_t)(ni * nj) * sizeof(double));
    memset(gy, 0, (size_t)(ni * nj) * sizeof(double));
    for (ptrdiff_t i = 0; i < ni - 1; i++) {
        const double *xa = x + i * nj, *ya = y + i * nj;
        if (eps > 0.0)
            energy += cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &at_corner, &at_centre, 1, &r);
        else
            energy += cell_row(xa, ya, xa + nj, ya + nj, nj - 1, &at_corner, &at_centre, 0, &r);
        for (ptrdiff_t j = 0; j < nj - 1; j++)
            low = r.least[j] < low ? r.least[j] : low;
        scatter(r.sx, r.nx, r.wx, r.ex, gx + i * nj, gx + (i + 1) * nj, nj - 1);
        scatter(r.sy, r.ny, r.wy, r.ey, gy + i * nj, gy + (i + 1) * nj, nj - 1);
    }
    *smallest = low;
    if (!(eps > 0.0) && !(low > 0.0))
        return INFINITY;
    if (weights->smoothness > 0.0) {
        const double by_i = weights->smoothness / cells * (double)((ni - 1) * (ni - 1));
        const double by_j = weights->smoothness / cells * (double)((nj - 1) * (nj - 1));
        double *length = work, *inverse = work + ni * nj;
        const int p = weights->periodic;
        energy += family(x, y, nj, ni - 1, nj, nj, p, by_i, by_j, gx, gy, length, inverse, rows);
        energy += family(x, y, nj, ni, nj - 1, 1, p, by_i, by_j, gx, gy, length, inverse, rows);
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
        const double found = variational_energy(at, at + nodes, ni, nj, weights, fresh, fresh + nodes, &low, work);
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
    double low, value = variational_energy(z, z + nodes, ni, nj, weights, room, room + nodes, &low, room + 6 * nodes);
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
    *doubles = 4 * (size_t)(d->ni * d->nj) + variational_workspace(d->ni, d->nj) + 4 * (size_t)free_nodes;
    *floats = 2 * (size_t)free_nodes + steps_floats(2 * free_nodes) + 6 * (size_t)s->mi * widest + PANEL * DEPTH +
              (size_t)(ROWS * s->mj);
}

void descent_place(Descent *d, double *doubles, float *floats)
{
    const ptrdiff_t nodes = d->ni * d->nj, n = 2 * d->spectrum.mi * d->spectrum.mj;
    d->full = doubles, d->work = d->full + 4 * nodes;
    double *gradient = d->work + variational_workspace(d->ni, d->nj);
    d->frame = floats;
    steps_place(&d->steps, n, gradient, gradient + n, floats + n);
    d->transform = floats + n + steps_floats(n);
}

/* Planes of z moved by `factor` directions. */
MESHONET_CLONES
static void move(const Descent *d, double factor, double *restrict to)
{
    const ptrdiff_t nj = d->nj, nodes = d->ni * nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    memcpy(to, d->z, 2 * (size_t)nodes * sizeof *to);
    for (int c = 0; c < 2; c++) {
        for (ptrdiff_t i = 0; i < mi; i++) {
            const float *restrict step = d->steps.direction + (c * mi + i) * mj;
            double *restrict row = to + c * nodes + (d->first + i) * nj + 1;
            for (ptrdiff_t j = 0; j < mj; j++)
                row[j] += factor * (double)step[j];
        }
        if (d->weights.periodic)
            memcpy(to + c * nodes + (d->ni - 1) * nj, to + c * nodes, (size_t)nj * sizeof *to);
    }
}

static double attempt(void *problem, double factor, double *smallest)
{
    Descent *d = problem;
    const ptrdiff_t nodes = d->ni * d->nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    const double *at = factor > 0.0 ? d->full : d->z;
    double *g = d->full + 2 * nodes;
    if (factor > 0.0)
        move(d, factor, d->full);
    const double value =
        variational_energy(at, at + nodes, d->ni, d->nj, &d->weights, g, g + nodes, smallest, d->work);
    for (int c = 0; c < 2; c++)
        for (ptrdiff_t i = 0; i < mi; i++)
            memcpy(d->steps.fresh + (c * mi + i) * mj, g + c * nodes + (d->first + i) * d->nj + 1,
                   (size_t)mj * sizeof *g);
    return value;
}

static void keep(void *problem)
{
    Descent *d = problem;
    memcpy(d->z, d->full, 2 * (size_t)(d->ni * d->nj) * sizeof *d->z);
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
