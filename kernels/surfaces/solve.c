/* Rows of nodes that are nobody's neighbour among themselves (red) have a diagonal that is a number; eliminated, they
   leave a system of the others, half as many, whose matrix is applied in two sweeps over neighbours. It is solved by
   BiCGStab: van der Vorst, SIAM J. Sci. Stat. Comput. 13 (1992) 631. No order of nodes is lost to threads. */
#include "solve.h"
#include "sums.h"
#include <math.h>

MESHONET_INLINE Vector flux_of(const float *flux, ptrdiff_t n, Vector a, Vector b)
{
    return (Vector){flux[0] * a.x + flux[n] * a.y + flux[2 * n] * a.z + flux[9 * n] * b.x + flux[10 * n] * b.y +
                        flux[11 * n] * b.z,
                    flux[3 * n] * a.x + flux[4 * n] * a.y + flux[5 * n] * a.z + flux[12 * n] * b.x +
                        flux[13 * n] * b.y + flux[14 * n] * b.z,
                    flux[6 * n] * a.x + flux[7 * n] * a.y + flux[8 * n] * a.z + flux[15 * n] * b.x +
                        flux[16 * n] * b.y + flux[17 * n] * b.z};
}

/* The part of row i that belongs to its neighbours. */
MESHONET_INLINE Vector neighbours_part(const Step *s, const double *v, ptrdiff_t i)
{
    const Graph *g = s->graph;
    const ptrdiff_t n = g->nodes, rows = n + g->ghosts;
    const int *near = s->near;
    const Vector a = at(v, rows, near[i]), b = at(v, rows, near[n + i]);
    const Vector c = at(v, rows, near[2 * n + i]), d = at(v, rows, near[3 * n + i]);
    return minus(flux_of(s->flux + i, n, minus(a, c), minus(b, d)),
                 times(s->tie[i], plus(plus(a, b), plus(c, d))));
}

static Vector odd_part(const Step *s, const double *v, ptrdiff_t k)
{
    const Graph *g = s->graph;
    const ptrdiff_t rows = g->nodes + g->ghosts, i = g->odd_nodes[k], start = g->odd_start[k];
    const int count = (int)(g->odd_start[k + 1] - start);
    Vector xi = {0, 0, 0}, eta = {0, 0, 0}, sum = {0, 0, 0};
    for (int m = 0; m < count; m++) {
        const Vector near = at(v, rows, g->odd_near[start + m]);
        const double angle = 2.0 * M_PI * m / count;
        xi = plus(xi, times(4.0 / count * cos(angle), near));
        eta = plus(eta, times(4.0 / count * sin(angle), near));
        sum = plus(sum, near);
    }
    return minus(flux_of(s->flux + i, g->nodes, xi, eta), times(s->tie[i], sum));
}

/* Rows first .. last - 1 of red nodes solved for their own value, with `right` times the right side. */
MESHONET_CLONES
static void solve_red(const Step *step, double *v, double right, ptrdiff_t first, ptrdiff_t last)
{
    const Step s = *step;
    const Graph *g = s.graph;
    const ptrdiff_t n = g->nodes, rows = n + g->ghosts;
    fill_ghosts(g, v, first, last, 1);
    MESHONET_INDEPENDENT
    for (ptrdiff_t i = first; i < last; i++)
        put(v, rows, i, times(1.0 / s.diagonal[i], minus(times(right, at(s.right, n, i)), neighbours_part(&s, v, i))));
    for (ptrdiff_t k = first_from(g->odd_nodes, g->odd, first); k < g->odd && g->odd_nodes[k] < last; k++) {
        const ptrdiff_t i = g->odd_nodes[k];
        put(v, rows, i, times(1.0 / s.diagonal[i], minus(times(right, at(s.right, n, i)), odd_part(step, v, k))));
    }
    hold_in_planes(g, v, rows, first, last);
}

/* out = right times the right side + sign times the rows first .. last - 1 of v. */
MESHONET_CLONES
static void apply_rows(const Step *step, double *v, double *out, double right, double sign, ptrdiff_t first,
                       ptrdiff_t last)
{
    const Step s = *step;
    const Graph *g = s.graph;
    const ptrdiff_t n = g->nodes, rows = n + g->ghosts;
    fill_ghosts(g, v, first, last, 1);
    MESHONET_INDEPENDENT
    for (ptrdiff_t i = first; i < last; i++) {
        const Vector row = plus(times(s.diagonal[i], at(v, rows, i)), neighbours_part(&s, v, i));
        put(out, n, i, plus(times(right, at(s.right, n, i)), times(sign, row)));
    }
    for (ptrdiff_t k = first_from(g->odd_nodes, g->odd, first); k < g->odd && g->odd_nodes[k] < last; k++) {
        const ptrdiff_t i = g->odd_nodes[k];
        const Vector row = plus(times(s.diagonal[i], at(v, rows, i)), odd_part(step, v, k));
        put(out, n, i, plus(times(right, at(s.right, n, i)), times(sign, row)));
    }
    hold_in_planes(g, out, n, first, last);
}

/* The product of some nodes of a, its coordinates n apart, and of b, `rows` apart. */
MESHONET_CLONES
static double dot_chunk(const double *a, ptrdiff_t n, const double *b, ptrdiff_t rows, Range range)
{
    double sum = 0.0;
    for (int d = 0; d < 3; d++)
        sum += product_of(a + d * n + range.first, b + d * rows + range.first, range.last - range.first);
    return sum;
}

/* p = r + beta (p - omega v) */
MESHONET_CLONES
static void turn_chunk(const Solver *solver, double beta, double omega, Range range)
{
    const ptrdiff_t n = solver->step.graph->nodes, rows = n + solver->step.graph->ghosts;
    for (int d = 0; d < 3; d++) {
        double *restrict p = solver->p + d * rows;
        const double *restrict r = solver->r + d * n, *restrict v = solver->v + d * n;
        for (ptrdiff_t i = range.first; i < range.last; i++)
            p[i] = r[i] + beta * (p[i] - omega * v[i]);
    }
}

/* s = r - alpha v; returns s . s */
MESHONET_CLONES
static double halve_chunk(const Solver *solver, double alpha, Range range)
{
    const ptrdiff_t n = solver->step.graph->nodes, rows = n + solver->step.graph->ghosts;
    for (int d = 0; d < 3; d++) {
        double *restrict s = solver->s + d * rows;
        const double *restrict r = solver->r + d * n, *restrict v = solver->v + d * n;
        for (ptrdiff_t i = range.first; i < range.last; i++)
            s[i] = r[i] - alpha * v[i];
    }
    return dot_chunk(solver->s, rows, solver->s, rows, range);
}

/* change += alpha p + omega s, r = s - omega t; returns r . r, and r0 . r in `turned`. */
MESHONET_CLONES
static double advance_chunk(const Solver *solver, double alpha, double omega, Range range, double *turned)
{
    const ptrdiff_t n = solver->step.graph->nodes, rows = n + solver->step.graph->ghosts;
    for (int d = 0; d < 3; d++) {
        const double *restrict s = solver->s + d * rows, *restrict p = solver->p + d * rows;
        const double *restrict t = solver->t + d * n;
        double *restrict r = solver->r + d * n, *restrict y = solver->step.change + d * rows;
        for (ptrdiff_t i = range.first; i < range.last; i++) {
            y[i] += alpha * p[i] + omega * s[i];
            r[i] = s[i] - omega * t[i];
        }
    }
    *turned = dot_chunk(solver->r0, n, solver->r, n, range);
    return dot_chunk(solver->r, n, solver->r, n, range);
}

typedef struct {
    Range red, black; /* chunks of this thread */
} Share;

static double whole_sum(const Solver *solver, int which)
{
    return sum_of(solver->sums + which * solver->chunks, solver->chunks);
}

static void put_sum(const Solver *solver, int which, ptrdiff_t chunk, double value)
{
    solver->sums[which * solver->chunks + chunk] = value;
}

/* out = matrix of the black nodes times v, whose red part is filled. */
static void apply(const Solver *solver, Share share, double *v, double *out, Member member)
{
    EACH(solver, chunk, share.red, range)
        solve_red(&solver->step, v, 0.0, range.first, range.last);
    team_wait(member);
    EACH(solver, chunk, share.black, range)
        apply_rows(&solver->step, v, out, 0.0, 1.0, range.first, range.last);
}

/* Residual of the start; returns the norms of the right side, squared, and of the residual. */
static double begin(const Solver *solver, Share share, double *residual, Member member)
{
    const Step *step = &solver->step;
    const ptrdiff_t n = step->graph->nodes, rows = n + step->graph->ghosts;
    EACH(solver, chunk, share.red, range) {
        solve_red(step, step->change, 1.0, range.first, range.last);
        put_sum(solver, 0, chunk, dot_chunk(step->right, n, step->right, n, range));
        for (int which = 1; which < SUMS; which++)
            put_sum(solver, which, chunk, 0.0);
    }
    team_wait(member);
    EACH(solver, chunk, share.black, range) {
        apply_rows(step, step->change, solver->r, 1.0, -1.0, range.first, range.last);
        for (int d = 0; d < 3; d++)
            for (ptrdiff_t i = range.first; i < range.last; i++) {
                solver->p[d * rows + i] = solver->v[d * n + i] = 0.0;
                solver->r0[d * n + i] = solver->r[d * n + i];
            }
        put_sum(solver, 0, chunk, dot_chunk(step->right, n, step->right, n, range));
        put_sum(solver, 1, chunk, dot_chunk(solver->r, n, solver->r, n, range));
    }
    team_wait(member);
    *residual = whole_sum(solver, 1);
    return whole_sum(solver, 0);
}

int solve_step(Solver *solver, Member member)
{
    const ptrdiff_t n = solver->step.graph->nodes;
    const ptrdiff_t red = solver->red_chunks;
    Share share = {team_share(red, member), team_share(solver->chunks - red, member)};
    share.black.first += red, share.black.last += red;
    double residual, rho = 1.0, alpha = 1.0, omega = 1.0;
    const double enough = solver->tolerance * solver->tolerance * begin(solver, share, &residual, member);
    double turned = residual; /* r0 . r */
    int k = 0;
    for (; k < solver->most && residual > enough; k++) {
        const double beta = turned / rho * alpha / omega;
        rho = turned;
        EACH(solver, chunk, share.black, range)
            turn_chunk(solver, beta, omega, range);
        team_wait(member);
        apply(solver, share, solver->p, solver->v, member);
        EACH(solver, chunk, share.black, range)
            put_sum(solver, 2, chunk, dot_chunk(solver->r0, n, solver->v, n, range));
        team_wait(member);
        alpha = rho / whole_sum(solver, 2);
        EACH(solver, chunk, share.black, range)
            put_sum(solver, 3, chunk, halve_chunk(solver, alpha, range));
        team_wait(member);
        apply(solver, share, solver->s, solver->t, member);
        EACH(solver, chunk, share.black, range) {
            const ptrdiff_t rows = n + solver->step.graph->ghosts;
            put_sum(solver, 4, chunk, dot_chunk(solver->t, n, solver->s, rows, range));
            put_sum(solver, 5, chunk, dot_chunk(solver->t, n, solver->t, n, range));
        }
        team_wait(member);
        const double square = whole_sum(solver, 5);
        omega = square > 0.0 ? whole_sum(solver, 4) / square : 0.0;
        EACH(solver, chunk, share.black, range) {
            double other;
            put_sum(solver, 0, chunk, advance_chunk(solver, alpha, omega, range, &other));
            put_sum(solver, 1, chunk, other);
        }
        EACH(solver, chunk, share.red, range)
            put_sum(solver, 0, chunk, 0.0);
        team_wait(member);
        residual = whole_sum(solver, 0), turned = whole_sum(solver, 1);
        if (!(residual < INFINITY) || omega == 0.0)
            break;
    }
    EACH(solver, chunk, share.red, range)
        solve_red(&solver->step, solver->step.change, 1.0, range.first, range.last);
    team_wait(member);
    return residual <= 1e-2 * enough / (solver->tolerance * solver->tolerance) ? k : -1 - k;
}
