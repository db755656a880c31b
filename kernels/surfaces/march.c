/* A march from a surface to the far field: sub-steps of the size that cells allow, levels kept where they are asked.

   The volume of a step is its length times the area around a node, smoothed over neighbours, by and by from the wall
   on, and drawn to the mean: V <- f V + (1 - f) mean V, f = (1 + (1 - blend)^(level - 1))/2. Its height is volume over
   area. step.c has the equations of a step.

   Fronts that spread, or are smoothed, come less far than the steps are long: what a step comes to, on average over the
   surface, is measured, and the next one is made as much longer. */
#include "march.h"
#include "relax.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double FAR_POWER = 0.15; /* of the height over the size, by which smoothing sets in */
static const double LEAST_IMPLICIT = 1.5; /* smoothing, over the explicit one: steps stay stable */
static const double LEAST_YIELD = 0.3; /* volume swept by that of a straight march, at least */
enum { HALVINGS = 2 };

typedef struct {
    Solver solver;
    const SurfaceMarch *settings;
    double *levels;
    const double *heights;
    ptrdiff_t count;
    double *volume, *other; /* (rows) */
    double *moves;          /* (3, nodes): of a relaxed front */
    SurfaceMarched *made;
} March;

typedef struct {
    Solver solver; /* a copy, with pointers that are swapped alike by all threads */
    double *volume, *other;
    double gone, last, shortest; /* mean distance so far, the step before, the least reach */
    double yield;                /* mean distance that a step came to, over its length */
    Range chunks;                /* of this thread */
    Member member;
} Runner;

static void measure(const March *m, Runner *r)
{
    EACH(&r->solver, c, r->chunks, range) {
        r->solver.sums[c] = step_sizes(&r->solver.step, range.first, range.last);
        if (m->settings->relaxing > 0.0)
            r->solver.sums[c] = nearest_reach(&r->solver.step, range.first, range.last);
    }
    team_wait(r->member);
    r->shortest = r->solver.sums[0];
    for (ptrdiff_t c = 1; c < r->solver.chunks; c++)
        if (!(r->solver.sums[c] >= r->shortest))
            r->shortest = r->solver.sums[c];
}

static void swap(double **a, double **b)
{
    double *held = *a;
    *a = *b, *b = held;
}

/* How far the smoothing of volumes has set in. */
static double part_of(const SurfaceMarch *set, ptrdiff_t level)
{
    return set->ramp > 0 ? fmin(1.0, (double)(level - 1) / (double)set->ramp) : 1.0;
}

/* Volumes of a unit step in r->volume, and their mean. */
static double smooth_volumes(const March *m, Runner *r, double part)
{
    const SurfaceMarch *set = m->settings;
    const Graph *g = r->solver.step.graph;
    const ptrdiff_t sweeps = part > 0.0 ? set->sweeps : 0, chunks = r->solver.chunks;
    for (ptrdiff_t k = 0; k <= sweeps; k++) {
        const double *from = k ? r->volume : r->solver.step.area;
        EACH(&r->solver, c, r->chunks, range) {
            double *values = (double *)from, *sums = r->solver.sums + chunks;
            fill_equal_ghosts(g, values, range.first, range.last);
            sums[c] = step_smooth(&r->solver.step, values, r->other, k ? set->weight : 0.0, range.first, range.last);
        }
        team_wait(r->member);
        swap(&r->volume, &r->other);
    }
    double sum = 0.0;
    for (ptrdiff_t c = 0; c < chunks; c++)
        sum += r->solver.sums[chunks + c];
    return sum / (double)g->nodes;
}

MESHONET_CLONES
static void heights_chunk(const Step *step, const double *volume, double length, double part, double keep, double mean,
                          double again, ptrdiff_t first, ptrdiff_t last)
{
    const Graph *g = step->graph;
    const ptrdiff_t rows = g->nodes + g->ghosts;
    const double *restrict area = step->area;
    double *restrict height = step->height;
    for (ptrdiff_t i = first; i < last; i++) {
        const double v = (1.0 - part) * area[i] + part * volume[i];
        height[i] = length * (keep * v + (1.0 - keep) * mean) / area[i];
    }
    for (int d = 0; d < 3; d++)
        for (ptrdiff_t i = first; i < last; i++)
            step->change[d * rows + i] = again == 0.0 ? 0.0 : again * step->change[d * rows + i]; /* not NaN */
}

/* Move to the next level; returns the distances times the areas, which are added to `areas`. */
MESHONET_CLONES
static double advance_chunk(const Step *step, double *areas, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t rows = step->graph->nodes + step->graph->ghosts;
    double *restrict x = step->x;
    const double *restrict dx = step->change, *restrict dy = dx + rows, *restrict dz = dy + rows;
    double swept = 0.0, area = 0.0;
    for (ptrdiff_t i = first; i < last; i++) {
        x[i] += dx[i], x[rows + i] += dy[i], x[2 * rows + i] += dz[i];
        swept += step->area[i] * sqrt(dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]);
        area += step->area[i];
    }
    *areas = area;
    return swept;
}

/* Add the step to the level; how far it came is kept for the next one. */
static void advance(Runner *r, double length)
{
    double *sums = r->solver.sums;
    const ptrdiff_t chunks = r->solver.chunks;
    EACH(&r->solver, c, r->chunks, range)
        sums[2 * chunks + c] = advance_chunk(&r->solver.step, sums + 3 * chunks + c, range.first, range.last);
    team_wait(r->member);
    double swept = 0.0, area = 0.0;
    for (ptrdiff_t c = 0; c < chunks; c++)
        swept += sums[2 * chunks + c], area += sums[3 * chunks + c];
    r->gone += swept / area;
    r->yield = fmin(fmax(swept / area / length, LEAST_YIELD), 1.0);
    r->last = length;
}

/* Set up and solve a step of a length, from the displacement of the last one times `again`; returns iterations,
   negative where they diverged. */
static int solve_length(const March *m, Runner *r, double length, double again, double mean, ptrdiff_t level)
{
    const SurfaceMarch *set = m->settings;
    Step *step = &r->solver.step;
    const double part = part_of(set, level), keep = 0.5 * (1.0 + pow(1.0 - set->blend, (double)(level - 1)));
    const double far = fmin(1.0, pow((r->gone + length) / set->size, FAR_POWER));
    const double away = fmin(1.0, (r->gone + length) / set->size);
    const double outer = 1.0 + (set->outer - 1.0) * away;
    const double implicit = fmax(set->implicit_smoothing, LEAST_IMPLICIT * outer * set->explicit_smoothing);
    const StepRule rule = {set->explicit_smoothing, implicit, outer, set->theta, far, set->sharp, r->gone == 0.0};
    double *before = step->before;
    if (rule.first)
        step->before = step->along;
    EACH(&r->solver, c, r->chunks, range) {
        heights_chunk(step, r->volume, length, part, keep, mean, again, range.first, range.last);
        step_rows(step, &rule, range.first, range.last);
    }
    step->before = before;
    team_wait(r->member);
    return solve_step(&r->solver, r->member);
}

/* One step of the way `left` to a level, which becomes less; returns iterations, negative where it diverged. A step
   whose linear system is not solved is tried again half as long. */
static int take_step(const March *m, Runner *r, double *left, ptrdiff_t level)
{
    Step *step = &r->solver.step;
    measure(m, r);
    const double whole = *left / r->yield;
    double length = fmin(whole, m->settings->longest * r->shortest);
    if (whole > length && whole - length < 0.3 * length)
        length = 0.5 * whole;
    if (!(length > 0.0) || !(length < INFINITY))
        return -1;
    const double mean = smooth_volumes(m, r, part_of(m->settings, level));
    int iterations = solve_length(m, r, length, r->last > 0.0 ? length / r->last : 1.0, mean, level);
    for (int halved = 0; iterations < 0 && halved < HALVINGS; halved++) {
        length *= 0.5;
        iterations = solve_length(m, r, length, 0.0, mean, level);
    }
    *left = whole > length ? *left - length * r->yield : 0.0;
    swap(&step->along, &step->before);
    advance(r, length);
    const SurfaceMarch *set = m->settings;
    const Relaxing relaxing = {set->relaxing * length, r->gone / (set->settled * set->size), r->gone * set->near};
    if (set->relaxing > 0.0)
        for (ptrdiff_t k = 0; k < set->relaxations; k++)
            relax_front(&r->solver, m->moves, &relaxing, r->chunks, r->member);
    return iterations;
}

static void keep_level(const March *m, const Runner *r, ptrdiff_t level)
{
    const Graph *g = r->solver.step.graph;
    const ptrdiff_t n = g->nodes, rows = n + g->ghosts;
    EACH(&r->solver, c, r->chunks, range)
        for (int d = 0; d < 3; d++)
            memcpy(m->levels + (3 * level + d) * n + range.first, r->solver.step.x + d * rows + range.first,
                   (size_t)(range.last - range.first) * sizeof(double));
}

static void run(void *data, Member member)
{
    const March *m = data;
    Runner r = {.solver = m->solver, .volume = m->volume, .other = m->other, .member = member, .yield = 1.0,
                .chunks = team_share(m->solver.chunks, member)};
    ptrdiff_t steps = 0, iterations = 0, level = 1;
    for (int fine = 1; fine && level <= m->count; level++) {
        ptrdiff_t here = 0;
        for (double left = m->heights[level - 1] - (level > 1 ? m->heights[level - 2] : 0.0); fine && left > 0.0;) {
            const int taken = take_step(m, &r, &left, level);
            steps++, here++, iterations += taken < 0 ? -taken : taken;
            fine = taken >= 0 && (here < m->settings->most || left == 0.0);
        }
        if (!fine)
            break;
        keep_level(m, &r, level);
    }
    if (member.rank == 0)
        *m->made = (SurfaceMarched){level - 1, steps, iterations};
}

int surface_march(double *levels, const double *heights, ptrdiff_t count, const Graph *graph,
                  const SurfaceMarch *settings, int threads, SurfaceMarched *made)
{
    const ptrdiff_t n = graph->nodes, rows = n + graph->ghosts;
    March m = {.settings = settings, .levels = levels, .heights = heights, .count = count, .made = made};
    Solver *s = &m.solver;
    s->step.graph = graph, s->tolerance = settings->tolerance, s->most = 60;
    s->red_chunks = (graph->red + CHUNK - 1) / CHUNK;
    s->chunks = s->red_chunks + (n - graph->red + CHUNK - 1) / CHUNK;
    double **long_ones[] = {&s->step.x, &s->step.change, &s->p, &s->s};
    double **short_ones[] = {&s->step.right, &s->r, &s->r0, &s->v, &s->t};
    double **single[] = {&s->step.area, &m.volume, &m.other};
    double **plain[] = {&s->step.reach, &s->step.height};
    const ptrdiff_t moves = settings->relaxing > 0.0 ? 3 * n : 0;
    double *room = calloc((size_t)(15 * rows + 33 * n + SUMS * s->chunks + moves), sizeof(double));
    if (room == NULL)
        return -1;
    double *next = room;
    for (int k = 0; k < 4; k++, next += 3 * rows)
        *long_ones[k] = next;
    for (int k = 0; k < 5; k++, next += 3 * n)
        *short_ones[k] = next;
    for (int k = 0; k < 3; k++, next += rows)
        *single[k] = next;
    for (int k = 0; k < 2; k++, next += n)
        *plain[k] = next;
    s->step.along = next, s->step.before = next + 2 * n, s->sums = next + 4 * n;
    s->step.flux = (float *)(next + 4 * n + SUMS * s->chunks);
    s->step.diagonal = s->step.flux + 18 * n, s->step.tie = s->step.flux + 19 * n;
    int *near = (int *)(s->step.flux + 20 * n);
    for (ptrdiff_t k = 0; k < 4 * n; k++)
        near[k] = (int)graph->near[k];
    s->step.near = near;
    m.moves = next + 16 * n + SUMS * s->chunks;
    for (int d = 0; d < 3; d++)
        memcpy(s->step.x + d * rows, levels + d * n, (size_t)n * sizeof(double));
    team_run(threads, run, &m);
    free(room);
    return 0;
}
