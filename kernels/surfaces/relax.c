/* Fronts relaxed between the steps of a march. Without it, lines that start beside a concave edge are squeezed at the
   bisector of its faces by the time the front has gone as far as they start from the edge: smoothing in the equations
   of a step scales with the length of edges and vanishes just there. */
#include "relax.h"
#include "elementary.h"
#include <math.h>

typedef struct {
    Vector mean, normal;
    double shortest; /* squared */
} Around;

MESHONET_INLINE Vector part_of_way(const Around *a, const Relaxing *r, double hollow)
{
    const double size = sqrt(dot(a->normal, a->normal));
    const Vector normal = times(size > 0.0 ? 1.0 / size : 0.0, a->normal);
    const double rise = dot(a->mean, normal);
    const double near = r->near / larger(hollow, 1e-300);
    const double away = smaller(1.0, larger(r->away, near * near));
    const double part = smaller(0.5, away * r->way / larger(sqrt(a->shortest), 1e-300));
    return times(part, minus(a->mean, times(smaller(rise, 0.0), normal)));
}

static Vector odd_move(const Step *s, const Relaxing *relaxing, ptrdiff_t k)
{
    const Graph *g = s->graph;
    const ptrdiff_t rows = g->nodes + g->ghosts, start = g->odd_start[k], count = g->odd_start[k + 1] - start;
    const Vector x = at(s->x, rows, g->odd_nodes[k]);
    Around a = {{0, 0, 0}, {0, 0, 0}, INFINITY};
    for (ptrdiff_t m = 0; m < count; m++) {
        const Vector e = minus(at(s->x, rows, g->odd_near[start + m]), x);
        const Vector next = minus(at(s->x, rows, g->odd_near[start + (m + 1) % count]), x);
        a.mean = plus(a.mean, times(1.0 / (double)count, e));
        a.normal = plus(a.normal, cross(e, next));
        a.shortest = smaller(a.shortest, dot(e, e));
    }
    return part_of_way(&a, relaxing, g->hollow[g->odd_nodes[k]]);
}

MESHONET_CLONES
static void moves_chunk(const Step *step, double *moves, const Relaxing *relaxing, ptrdiff_t first, ptrdiff_t last)
{
    const Step s = *step;
    const Relaxing r = *relaxing;
    const Graph *g = s.graph;
    const ptrdiff_t n = g->nodes, rows = n + g->ghosts;
    const int *near = s.near;
    fill_ghosts(g, s.x, first, last, 0);
    MESHONET_INDEPENDENT
    for (ptrdiff_t i = first; i < last; i++) {
        const Vector x = at(s.x, rows, i);
        const Vector a = minus(at(s.x, rows, near[i]), x), b = minus(at(s.x, rows, near[n + i]), x);
        const Vector c = minus(at(s.x, rows, near[2 * n + i]), x), d = minus(at(s.x, rows, near[3 * n + i]), x);
        const Around around = {times(0.25, plus(plus(a, b), plus(c, d))), cross(minus(a, c), minus(b, d)),
                               smaller(smaller(dot(a, a), dot(b, b)), smaller(dot(c, c), dot(d, d)))};
        put(moves, n, i, part_of_way(&around, &r, g->hollow[i]));
    }
    for (ptrdiff_t k = first_from(g->odd_nodes, g->odd, first); k < g->odd && g->odd_nodes[k] < last; k++)
        put(moves, n, g->odd_nodes[k], odd_move(step, relaxing, k));
    hold_in_planes(g, moves, n, first, last);
}

void relax_front(Solver *solver, double *moves, const Relaxing *relaxing, Range chunks, Member member)
{
    const Step *step = &solver->step;
    const ptrdiff_t n = step->graph->nodes, rows = n + step->graph->ghosts;
    EACH(solver, c, chunks, range)
        moves_chunk(step, moves, relaxing, range.first, range.last);
    team_wait(member);
    EACH(solver, c, chunks, range)
        for (int d = 0; d < 3; d++)
            for (ptrdiff_t i = range.first; i < range.last; i++)
                step->x[d * rows + i] += moves[d * n + i];
    team_wait(member);
}

double nearest_reach(const Step *step, ptrdiff_t first, ptrdiff_t last)
{
    const ptrdiff_t n = step->graph->nodes;
    double least = INFINITY;
    for (ptrdiff_t i = first; i < last; i++) {
        const double shorter = 0.5 * smaller(step->along[i], step->along[n + i]);
        step->reach[i] = smaller(step->reach[i], shorter);
        least = smaller(least, step->reach[i]);
    }
    return least;
}
