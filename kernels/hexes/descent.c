/* The functional over hexahedra for steps.c: moves, values, and a preconditioner: the nodes' stiffness, or D M⁻¹ D in one
   block (spectrum.h). */
#include "descent.h"
#include "clones.h"
#include <math.h>
#include <string.h>

#define CLOSER 0.4 /* smallest ratio of the smallest Jacobian after a step to that before */
#define ALONE 4096 /* largest number of places for one thread */

void hex_descent_sizes(const HexDescent *d, size_t *doubles, size_t *floats)
{
    *doubles = (size_t)(13 * d->count) + (size_t)d->threads * hex_room(&d->mesh);
    *floats = steps_floats(3 * d->count) + spectrum3_floats(&d->spectrum);
}

void hex_descent_place(HexDescent *d, double *doubles, float *floats)
{
    const ptrdiff_t n = 3 * d->count;
    d->here = doubles, d->there = d->here + n;
    d->stiffness = d->there + n;
    steps_place(&d->steps, n, d->stiffness + d->count, d->stiffness + d->count + n, floats);
    d->room = d->stiffness + d->count + 2 * n;
    d->steps.threads = d->spectrum.threads = d->mesh.places <= ALONE ? 1 : d->threads;
    spectrum3_place(&d->spectrum, floats + steps_floats(n));
}

/* Nodes from unknowns. */
static void set_nodes(HexDescent *d, const double *at, ptrdiff_t first, ptrdiff_t last)
{
    for (ptrdiff_t k = first; k < last; k++)
        for (int c = 0; c < 3; c++)
            d->x[3 * d->free[k] + c] = at[c * d->count + k];
}

/* Sums of `planes` of forces on nodes from `first` on, in the order of their places. */
static void gather(const HexDescent *d, int planes, double *to, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t P = d->mesh.places;
    for (ptrdiff_t k = first; k < last; k++) {
        const double *g = d->mesh.g + d->place[d->start[k]];
        for (int c = 0; c < planes; c++)
            to[c * d->count + k] = g[c * P];
        for (ptrdiff_t p = d->start[k] + 1; p < d->start[k + 1]; p++)
            for (int c = 0; c < planes; c++)
                to[c * d->count + k] += d->mesh.g[c * P + d->place[p]];
    }
}

MESHONET_CLONES
static void move_nodes(HexDescent *d, ptrdiff_t first, ptrdiff_t last)
{
    const float *restrict direction = d->steps.direction;
    const double *restrict here = d->here, factor = d->factor;
    double *restrict there = d->there;
    for (int c = 0; c < 3; c++)
        for (ptrdiff_t k = c * d->count + first; k < c * d->count + last; k++)
            there[k] = here[k] + (factor > 0.0 ? factor * (double)direction[k] : 0.0);
    set_nodes(d, there, first, last);
}

static void value_work(void *data, Member member)
{
    HexDescent *d = data;
    const Range mine = team_share(d->count, member);
    move_nodes(d, mine.first, mine.last);
    team_wait(member);
    hex_energy(&d->mesh, &d->weights, d->x, d->room + (size_t)member.rank * hex_room(&d->mesh), member);
    gather(d, 3, d->steps.fresh, mine.first, mine.last);
}

static void stiffness_work(void *data, Member member)
{
    HexDescent *d = data;
    const Range mine = team_share(d->count, member);
    set_nodes(d, d->here, mine.first, mine.last);
    team_wait(member);
    hex_stiffness(&d->mesh, &d->weights, d->x, d->spectrum.m[0] == 0,
                  d->room + (size_t)member.rank * hex_room(&d->mesh), member);
    gather(d, 1, d->stiffness, mine.first, mine.last);
}

static double attempt(void *problem, double factor, double *smallest)
{
    HexDescent *d = problem;
    double *fresh = d->steps.fresh;
    d->factor = factor;
    team_run(d->steps.threads, value_work, d);
    for (ptrdiff_t k = 0; k < d->sliding_count; k++) {
        const double *by = d->projection + 9 * k;
        double *g[3] = {fresh + d->sliding[k], fresh + d->sliding[k] + d->count, fresh + d->sliding[k] + 2 * d->count};
        const double x = *g[0], y = *g[1], z = *g[2];
        for (int c = 0; c < 3; c++)
            *g[c] = by[3 * c] * x + by[3 * c + 1] * y + by[3 * c + 2] * z;
    }
    const double value = hex_sum(&d->mesh, &d->weights, smallest);
    const int close = factor > 0.0 && !(d->weights.epsilon > 0.0) && *smallest < CLOSER * d->steps.smallest;
    return close ? INFINITY : value;
}

static void keep(void *problem)
{
    HexDescent *d = problem;
    memcpy(d->here, d->there, 3 * (size_t)d->count * sizeof *d->here);
}

static void precondition(void *problem, const double *gradient, float *result)
{
    HexDescent *d = problem;
    if (d->spectrum.m[0] > 0) {
        spectrum3_divide(&d->spectrum, gradient, result);
        return;
    }
    for (int c = 0; c < 3; c++)
        for (ptrdiff_t k = 0; k < d->count; k++)
            result[c * d->count + k] = (float)(gradient[c * d->count + k] / d->stiffness[k]);
}

MESHONET_CLONES
static double largest_move(void *problem)
{
    const HexDescent *d = problem;
    const float *restrict x = d->steps.direction, *restrict y = x + d->count, *restrict z = y + d->count;
    double most = 0.0;
    for (ptrdiff_t k = 0; k < d->count; k++) {
        const double p = x[k], q = y[k], r = z[k], size = d->inverse_size[k];
        const double move = (p * p + q * q + r * r) * size * size;
        most = move > most ? move : most;
    }
    return sqrt(most);
}

void hex_descent_renew(HexDescent *d)
{
    double largest = 0.0;
    team_run(d->steps.threads, stiffness_work, d);
    for (ptrdiff_t k = 0; k < d->count; k++)
        largest = d->stiffness[k] > largest ? d->stiffness[k] : largest;
    for (ptrdiff_t k = 0; k < d->count; k++)
        if (!(d->stiffness[k] > 1e-14 * largest))
            d->stiffness[k] = largest > 0.0 ? largest : 1.0;
    if (d->spectrum.m[0] > 0)
        spectrum3_renew(&d->spectrum, &d->weights, d->stiffness);
}

static void take_nodes(HexDescent *d)
{
    for (ptrdiff_t k = 0; k < d->count; k++)
        for (int c = 0; c < 3; c++)
            d->here[c * d->count + k] = d->x[3 * d->free[k] + c];
}

void hex_descent_start(HexDescent *d)
{
    Steps *s = &d->steps;
    s->problem = d, s->attempt = attempt, s->keep = keep, s->precondition = precondition;
    s->largest_move = largest_move;
    take_nodes(d);
    hex_descent_renew(d);
    steps_start(s);
}

double hex_descent_smallest(HexDescent *d)
{
    double smallest;
    take_nodes(d);
    attempt(d, 0.0, &smallest);
    return smallest;
}

void hex_descent_end(HexDescent *d)
{
    set_nodes(d, d->here, 0, d->count);
}
