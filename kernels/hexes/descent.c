/* What steps.c needs of the functional over hexahedra: moves, values and a preconditioner. */
#include "descent.h"
#include "clones.h"
#include "team.h"
#include <math.h>
#include <string.h>

#define ALONE 16 /* bricks up to which more threads would wait more than they work */

size_t hex_descent_doubles(const HexDescent *d)
{
    return (size_t)(13 * d->count) + (size_t)(d->threads < 1 ? 1 : d->threads) * brick_room();
}

void hex_descent_place(HexDescent *d, double *doubles, float *floats)
{
    const ptrdiff_t n = 3 * d->count;
    d->here = doubles, d->there = d->here + n;
    d->stiffness = d->there + n;
    steps_place(&d->steps, n, d->stiffness + d->count, d->stiffness + d->count + n, floats);
    d->room = d->stiffness + d->count + 2 * n;
}

/* Vector (3,) of a node that slides, as far as it may. */
static void project(const double *projection, double *v)
{
    const double x = v[0], y = v[1], z = v[2];
    for (int c = 0; c < 3; c++)
        v[c] = projection[3 * c] * x + projection[3 * c + 1] * y + projection[3 * c + 2] * z;
}

/* Nodes from unknowns. */
static void set_nodes(HexDescent *d, const double *at, ptrdiff_t first, ptrdiff_t last)
{
    for (ptrdiff_t k = first; k < last; k++)
        for (int c = 0; c < 3; c++)
            d->x[3 * d->free[k] + c] = at[3 * k + c];
}

/* Sums of the forces on nodes from `first` on, in the order of their places. */
static void gather(const HexDescent *d, double *to, ptrdiff_t first, ptrdiff_t last)
{
    for (ptrdiff_t k = first; k < last; k++) {
        double sum[3] = {0.0, 0.0, 0.0};
        for (ptrdiff_t p = d->start[k]; p < d->start[k + 1]; p++) {
            const double *force = d->mesh.force + 3 * (ptrdiff_t)d->place[p];
            for (int c = 0; c < 3; c++)
                sum[c] += force[c];
        }
        for (int c = 0; c < 3; c++)
            to[3 * k + c] = sum[c];
    }
}

static void value_work(void *data, Member member)
{
    HexDescent *d = data;
    ptrdiff_t first, last;
    team_share(d->count, member, &first, &last);
    const float *restrict direction = d->steps.direction;
    for (ptrdiff_t k = 3 * first; k < 3 * last; k++)
        d->there[k] = d->here[k] + (d->factor > 0.0 ? d->factor * (double)direction[k] : 0.0);
    set_nodes(d, d->there, first, last);
    team_wait(member);
    ptrdiff_t brick, end;
    team_share(d->mesh.bricks, member, &brick, &end);
    for (; brick < end; brick++) {
        brick_energy(&d->mesh, brick, &d->weights, d->x, d->room + (size_t)member.rank * brick_room());
        if (!isfinite(d->mesh.energy[brick]))
            break;
    }
    for (; brick < end; brick++) /* nobody looks at what was not worked out: the sum is infinite */
        d->mesh.energy[brick] = INFINITY;
    team_wait(member);
    gather(d, d->gathered, first, last);
}

static void stiffness_work(void *data, Member member)
{
    HexDescent *d = data;
    ptrdiff_t first, last;
    team_share(d->mesh.bricks, member, &first, &last);
    for (; first < last; first++)
        brick_stiffness(&d->mesh, first, &d->weights, d->x, d->room + (size_t)member.rank * brick_room());
    team_wait(member);
    team_share(d->count, member, &first, &last);
    gather(d, d->gathered, first, last);
}

static void together(HexDescent *d, TeamWork work)
{
    team_run(d->mesh.bricks <= ALONE ? 1 : d->threads, work, d);
}

static double attempt(void *problem, double factor, double *smallest)
{
    HexDescent *d = problem;
    double energy = 0.0, low = INFINITY;
    d->gathered = d->steps.fresh, d->factor = factor;
    together(d, value_work);
    for (ptrdiff_t k = 0; k < d->sliding_count; k++)
        project(d->projection + 9 * k, d->steps.fresh + 3 * d->sliding[k]);
    for (ptrdiff_t b = 0; b < d->mesh.bricks; b++) {
        energy += d->mesh.energy[b];
        low = d->mesh.least[b] < low ? d->mesh.least[b] : low;
    }
    *smallest = low;
    return isfinite(energy) ? energy : INFINITY;
}

static void keep(void *problem)
{
    HexDescent *d = problem;
    memcpy(d->here, d->there, 3 * (size_t)d->count * sizeof *d->here);
}

static void precondition(void *problem, const double *gradient, float *result)
{
    const HexDescent *d = problem;
    for (ptrdiff_t k = 0; k < d->count; k++)
        for (int c = 0; c < 3; c++)
            result[3 * k + c] = (float)(gradient[3 * k + c] / d->stiffness[k]);
}

static double largest_move(void *problem)
{
    const HexDescent *d = problem;
    const float *direction = d->steps.direction;
    double most = 0.0;
    for (ptrdiff_t k = 0; k < d->count; k++) {
        const double x = direction[3 * k], y = direction[3 * k + 1], z = direction[3 * k + 2];
        const double move = sqrt(x * x + y * y + z * z) * d->inverse_size[k];
        most = move > most ? move : most;
    }
    return most;
}

void hex_descent_renew(HexDescent *d)
{
    double largest = 0.0;
    set_nodes(d, d->here, 0, d->count);
    d->gathered = d->there;
    together(d, stiffness_work);
    for (ptrdiff_t k = 0; k < d->count; k++) {
        d->stiffness[k] = d->there[3 * k];
        largest = d->stiffness[k] > largest ? d->stiffness[k] : largest;
    }
    for (ptrdiff_t k = 0; k < d->count; k++)
        if (!(d->stiffness[k] > 1e-14 * largest))
            d->stiffness[k] = largest > 0.0 ? largest : 1.0;
    steps_start(&d->steps);
}

void hex_descent_start(HexDescent *d)
{
    Steps *s = &d->steps;
    s->problem = d, s->attempt = attempt, s->keep = keep, s->precondition = precondition;
    s->largest_move = largest_move;
    for (ptrdiff_t k = 0; k < d->count; k++)
        for (int c = 0; c < 3; c++)
            d->here[3 * k + c] = d->x[3 * d->free[k] + c];
    hex_descent_renew(d);
}

void hex_descent_end(HexDescent *d)
{
    set_nodes(d, d->here, 0, d->count);
}
