/* Descent of the variational functional: L-BFGS (steps.h) with a preconditioner (frame.h); the functional's gradient
   over a grid from its rows of cells (functional.h), and its Hessian on a coarse one. */
#include "variational.h"
#include "frame.h"
#include "functional.h"
#include "hessian.h"
#include "steps.h"

#define TRIES 25  /* lengths of a step that are tried */
#define IDLE 2    /* small changes in a row that count as standing still; one may come from a short step */
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

/* The factor to the minimum of the parabola through both values and the slope, .1 to .5. */
static double shorter(double rise, double slope)
{
    if (!isfinite(rise))
        return 0.5;
    const double factor = -0.5 * slope / (rise - slope);
    return factor < 0.1 ? 0.1 : factor > 0.5 ? 0.5 : factor;
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
    const ptrdiff_t nodes = values_of(&s->eta), modes = modes_of(&s->eta);
    const size_t free_nodes = (size_t)(s->mi * s->mj), widest = (size_t)(nodes > modes ? nodes : modes);
    *doubles = 4 * (size_t)(d->ni * d->nj) + variational_workspace(d->ni, d->nj) + 4 * free_nodes;
    *floats = (8 + 4 * PAIRS) * free_nodes + 6 * (size_t)s->mi * widest + PANEL * DEPTH + (size_t)(ROWS * s->mj);
}

void descent_place(Descent *d, double *doubles, float *floats)
{
    const ptrdiff_t nodes = d->ni * d->nj, n = 2 * d->spectrum.mi * d->spectrum.mj;
    d->full = doubles, d->work = d->full + 4 * nodes;
    d->gradient = d->work + variational_workspace(d->ni, d->nj), d->fresh = d->gradient + n;
    d->frame = floats, d->direction = d->frame + n, d->steepest = d->direction + n, d->turned = d->steepest + n;
    d->table = d->turned + n, d->transform = d->table + 2 * PAIRS * n;
}

/* Value at the planes `at`, and the gradient of the free nodes in `gradient`. */
static double evaluate(Descent *d, const double *at, double *gradient, double *smallest)
{
    const ptrdiff_t nodes = d->ni * d->nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    double *g = d->full + 2 * nodes;
    const double value =
        variational_energy(at, at + nodes, d->ni, d->nj, &d->weights, g, g + nodes, smallest, d->work);
    for (int c = 0; c < 2; c++)
        for (ptrdiff_t i = 0; i < mi; i++)
            memcpy(gradient + (c * mi + i) * mj, g + c * nodes + (d->first + i) * d->nj + 1, (size_t)mj * sizeof *g);
    return value;
}

void descent_start(Descent *d)
{
    set_frame(d);
    d->count = d->idle = 0;
    d->value = evaluate(d, d->z, d->gradient, &d->smallest);
    precondition(d, d->gradient, d->steepest);
}

/* Planes of z moved by `factor` directions. */
MESHONET_CLONES
static void move(const Descent *d, double factor, double *restrict to)
{
    const ptrdiff_t nj = d->nj, nodes = d->ni * nj, mi = d->spectrum.mi, mj = d->spectrum.mj;
    memcpy(to, d->z, 2 * (size_t)nodes * sizeof *to);
    for (int c = 0; c < 2; c++) {
        for (ptrdiff_t i = 0; i < mi; i++) {
            const float *restrict step = d->direction + (c * mi + i) * mj;
            double *restrict row = to + c * nodes + (d->first + i) * nj + 1;
            for (ptrdiff_t j = 0; j < mj; j++)
                row[j] += factor * (double)step[j];
        }
        if (d->weights.periodic)
            memcpy(to + c * nodes + (d->ni - 1) * nj, to + c * nodes, (size_t)nj * sizeof *to);
    }
}

int descent_step(Descent *d)
{
    const ptrdiff_t nodes = d->ni * d->nj, n = 2 * d->spectrum.mi * d->spectrum.mj;
    double slope = choose_direction(d);
    if (!(slope < 0.0) && d->count > 0) {
        d->count = 0;
        slope = choose_direction(d);
    }
    if (!(slope < 0.0))
        return STUCK;
    const double largest = largest_move(d);
    double factor = d->count == 0 && largest > d->reach ? d->reach / largest : 1.0, value = 0.0, low = 0.0;
    int tries = 0;
    for (; tries < TRIES; tries++) {
        move(d, factor, d->full);
        value = evaluate(d, d->full, d->fresh, &low);
        if (value <= d->value + 1e-4 * factor * slope)
            break;
        factor *= shorter(value - d->value, factor * slope);
    }
    if (tries == TRIES) { /* what is remembered misleads, or nothing helps */
        const int state = d->count > 0 ? GOES_ON : STUCK;
        d->count = 0;
        return state;
    }
    const double gain = d->value - value;
    memcpy(d->z, d->full, 2 * (size_t)nodes * sizeof *d->z);
    d->value = value, d->smallest = low;
    precondition(d, d->fresh, d->turned);
    remember(d, factor, slope);
    memcpy(d->gradient, d->fresh, (size_t)n * sizeof *d->gradient);
    memcpy(d->steepest, d->turned, (size_t)n * sizeof *d->steepest);
    /* small steps that still gain, or that were cut short, say nothing of the distance to the minimum */
    const int small = factor * largest < d->still && (factor > 0.4 || largest < d->still);
    d->idle = small && gain < GAIN * value ? d->idle + 1 : 0;
    return d->idle == IDLE ? SETTLED : GOES_ON;
}

double descent_slope(const Descent *d)
{
    double total = 0.0;
    for (ptrdiff_t k = 0; k < 2 * d->spectrum.mi * d->spectrum.mj; k++)
        total += d->gradient[k] * d->gradient[k];
    return sqrt(total);
}
