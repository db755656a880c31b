/* The linear system of one step of a march over a surface.

   With M neighbours at angles t_m = 2 pi m/M, r_xi = 2/M sum cos t_m r_m and r_eta the same with sin: central
   differences where M = 4. The step solves, with h the height and r_zeta = h n/|n|, n = r_xi x r_eta,
       dr + (1 + theta) (P^-1 Q1 dr_xi + P^-1 Q2 dr_eta) - 4 eps_i (mean of neighbours' dr - dr) = r_zeta + D,
   P = rows r_xi, r_eta, n; Q1 = rows r_zeta, 0, r_eta x r_zeta; Q2 = rows 0, r_zeta, r_zeta x r_xi: orthogonality and
   a prescribed volume, linearised, unfactored. Near the wall r_zeta leans to the normal of unit tangents. Chan and
   Steger, Appl. Math. Comput. 51 (1992) 181; D = 1/2 sum over directions of min(eps_e far d a N, 4) (second
   difference), N = h/|r_dir|, d = max((lengths before / now)^(2/far), .1), a = 1/max(1 - cos^2, .05) where edges rise
   along the normal: hollows. With M other than 4 the smoothing is alike in all directions. A node at an edge sharper
   than `sharp` moves with the mean of its neighbours. */
#include "step.h"
#include "elementary.h"
#include "sums.h"
#include <math.h>

static const double LEAST_SPREAD = 0.1, MOST_SPREAD = 1e3; /* of the factor d */
static const double MOST_SMOOTHING = 4.0, LEAST_SINE = 0.05; /* the sine squared */

/* What a node sees of its neighbours. */
typedef struct {
    Vector xi, eta, zeta, smooth;
    int averaged;
} Frame;

MESHONET_INLINE double spread(double before, double now, double power)
{
    const double exponent = smaller(larger(power * log_double(before / now), -30.0), 30.0);
    return smaller(larger(exp_double(exponent), LEAST_SPREAD), MOST_SPREAD);
}

/* How much more a direction is smoothed whose edges rise by `cosine` times their length. */
MESHONET_INLINE double hollow(double cosine)
{
    return cosine > 0.0 ? 1.0 / larger(1.0 - cosine * cosine, LEAST_SINE) : 1.0;
}

/* Whether faces of normals f and g meet at edge e sharper than the limit, convexly. */
MESHONET_INLINE int sharper(Vector f, Vector g, Vector e, double limit)
{
    const double c = dot(f, g);
    return (c < 0.0) & (c * c > limit * limit * dot(f, f) * dot(g, g)) & (dot(cross(f, g), e) > 0.0);
}

MESHONET_INLINE void put_row(const Step *s, const StepRule *rule, ptrdiff_t i, const Frame *f, double count)
{
    const ptrdiff_t n = s->graph->nodes;
    const double go = f->averaged ? 0.0 : 1.0;
    const Vector normal = cross(f->xi, f->eta);
    const double over = (1.0 + rule->theta) * 0.5 * go / larger(dot(normal, normal), 1e-300);
    const Vector p = times(over, cross(f->eta, normal)), q = times(over, cross(normal, f->xi)), r = times(over, normal);
    const Vector t = cross(f->eta, f->zeta), u = cross(f->zeta, f->xi), z = f->zeta;
    const double matrices[18] = {
        p.x * z.x + r.x * t.x, p.x * z.y + r.x * t.y, p.x * z.z + r.x * t.z, p.y * z.x + r.y * t.x,
        p.y * z.y + r.y * t.y, p.y * z.z + r.y * t.z, p.z * z.x + r.z * t.x, p.z * z.y + r.z * t.y,
        p.z * z.z + r.z * t.z, q.x * z.x + r.x * u.x, q.x * z.y + r.x * u.y, q.x * z.z + r.x * u.z,
        q.y * z.x + r.y * u.x, q.y * z.y + r.y * u.y, q.y * z.z + r.y * u.z, q.z * z.x + r.z * u.x,
        q.z * z.y + r.z * u.y, q.z * z.z + r.z * u.z};
#pragma GCC unroll 18
    for (int k = 0; k < 18; k++)
        s->flux[k * n + i] = (float)matrices[k];
    s->diagonal[i] = (float)(1.0 + go * 4.0 * rule->implicit_smoothing);
    s->tie[i] = (float)(f->averaged ? 1.0 / count : 4.0 / count * rule->implicit_smoothing);
    s->right[i] = go * (z.x + f->smooth.x), s->right[n + i] = go * (z.y + f->smooth.y);
    s->right[2 * n + i] = go * (z.z + f->smooth.z);
}

/* `smooth` and, of what it would be times `more`, the part within the level, across `normal`. */
MESHONET_INLINE Vector with_outer(Vector smooth, Vector more, Vector normal)
{
    const Vector extra = minus(more, smooth);
    const double square = dot(normal, normal);
    const double along = square > 0.0 ? dot(extra, normal) / square : 0.0;
    return plus(smooth, minus(extra, times(along, normal)));
}

MESHONET_INLINE void regular_row(const Step *s, const StepRule *rule, double power, ptrdiff_t i, const Vector *e)
{
    const ptrdiff_t n = s->graph->nodes;
    const double h = s->height[i], far = rule->far;
    const double l0 = sqrt(dot(e[0], e[0])), l1 = sqrt(dot(e[1], e[1]));
    const double l2 = sqrt(dot(e[2], e[2])), l3 = sqrt(dot(e[3], e[3]));
    Frame f;
    f.xi = times(0.5, minus(e[0], e[2])), f.eta = times(0.5, minus(e[1], e[3]));
    const Vector normal = cross(f.xi, f.eta);
    f.zeta = times(h / sqrt(dot(normal, normal)), normal);
    const Vector f0 = cross(e[0], e[1]), f1 = cross(e[1], e[2]), f2 = cross(e[2], e[3]), f3 = cross(e[3], e[0]);
    const double sharp = rule->sharp;
    f.averaged = sharper(f3, f0, e[0], sharp) | sharper(f0, f1, e[1], sharp) | sharper(f1, f2, e[2], sharp) |
                 sharper(f2, f3, e[3], sharp);
    const Vector u = cross(minus(times(1.0 / l0, e[0]), times(1.0 / l2, e[2])),
                           minus(times(1.0 / l1, e[1]), times(1.0 / l3, e[3])));
    const double length = sqrt(dot(u, u));
    const int plain = length > 1e-12;
    const Vector unit = times(plain ? 1.0 / length : 0.0, u);
    const double ai = hollow(dot(unit, e[0]) / l0), aj = hollow(dot(unit, e[1]) / l1);
    const Vector lean = plus(times(far, f.zeta), times((1.0 - far) * h, unit));
    const double size = sqrt(dot(lean, lean));
    f.zeta = times(plain & (size > 1e-300) ? h / size : 1.0, plain ? lean : f.zeta);
    const double first = rule->first ? 0.0 : 0.5;
    const double di = spread(s->before[i], l0 + l2, power), dj = spread(s->before[n + i], l1 + l3, power);
    const double strength = rule->explicit_smoothing * s->graph->boost[i] * far * h;
    const double wi = strength * di * ai / sqrt(dot(f.xi, f.xi)), wj = strength * dj * aj / sqrt(dot(f.eta, f.eta));
    const Vector bi = times(first, plus(e[0], e[2])), bj = times(first, plus(e[1], e[3]));
    f.smooth = plus(times(smaller(wi, MOST_SMOOTHING), bi), times(smaller(wj, MOST_SMOOTHING), bj));
    const Vector more = plus(times(smaller(rule->outer * wi, MOST_SMOOTHING), bi),
                             times(smaller(rule->outer * wj, MOST_SMOOTHING), bj));
    f.smooth = with_outer(f.smooth, more, f.zeta);
    put_row(s, rule, i, &f, 4.0);
}

static void odd_row(const Step *s, const StepRule *rule, double power, ptrdiff_t k)
{
    const Graph *g = s->graph;
    const ptrdiff_t rows = g->nodes + g->ghosts, i = g->odd_nodes[k], start = g->odd_start[k];
    const int count = (int)(g->odd_start[k + 1] - start);
    const double h = s->height[i];
    const Vector x = at(s->x, rows, i);
    Vector e[MOST_NEIGHBOURS], normals[MOST_NEIGHBOURS];
    Frame f = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 0};
    double length = 0.0;
    for (int m = 0; m < count; m++) {
        const double angle = 2.0 * M_PI * m / count;
        e[m] = minus(at(s->x, rows, g->odd_near[start + m]), x);
        length += sqrt(dot(e[m], e[m]));
        f.xi = plus(f.xi, times(2.0 / count * cos(angle), e[m]));
        f.eta = plus(f.eta, times(2.0 / count * sin(angle), e[m]));
        f.smooth = plus(f.smooth, e[m]);
    }
    for (int m = 0; m < count; m++)
        normals[m] = cross(e[m], e[(m + 1) % count]);
    for (int m = 0; m < count; m++)
        f.averaged |= sharper(normals[(m + count - 1) % count], normals[m], e[m], rule->sharp);
    const Vector normal = cross(f.xi, f.eta);
    f.zeta = times(h / sqrt(dot(normal, normal)), normal);
    const double d = spread(s->before[i], length, power);
    const double wanted = rule->explicit_smoothing * s->graph->boost[i] * rule->far * d * h * count / length;
    const Vector bend = times(rule->first ? 0.0 : 2.0 / count, f.smooth);
    const Vector more = times(smaller(rule->outer * wanted, MOST_SMOOTHING), bend);
    f.smooth = with_outer(times(smaller(wanted, MOST_SMOOTHING), bend), more, f.zeta);
    put_row(s, rule, i, &f, count);
}

MESHONET_CLONES
void step_rows(const Step *step, const StepRule *rule, ptrdiff_t first, ptrdiff_t last)
{
    const Step s = *step;
    const StepRule r = *rule;
    const Graph *g = s.graph;
    const ptrdiff_t n = g->nodes, rows = n + g->ghosts;
    const int *near = s.near;
    const double power = 2.0 / r.far;
    MESHONET_INDEPENDENT
    for (ptrdiff_t i = first; i < last; i++) {
        const Vector x = at(s.x, rows, i);
        const Vector e[4] = {minus(at(s.x, rows, near[i]), x), minus(at(s.x, rows, near[n + i]), x),
                             minus(at(s.x, rows, near[2 * n + i]), x), minus(at(s.x, rows, near[3 * n + i]), x)};
        regular_row(&s, &r, power, i, e);
    }
    for (ptrdiff_t k = first_from(g->odd_nodes, g->odd, first); k < g->odd && g->odd_nodes[k] < last; k++)
        odd_row(step, rule, power, k);
    hold_in_planes(g, s.right, n, first, last);
}

static void odd_sizes(const Step *s, ptrdiff_t k)
{
    const Graph *g = s->graph;
    const ptrdiff_t n = g->nodes, rows = n + g->ghosts, i = g->odd_nodes[k], start = g->odd_start[k];
    const ptrdiff_t count = g->odd_start[k + 1] - start;
    const Vector x = at(s->x, rows, i);
    double area = 0.0, length = 0.0;
    for (ptrdiff_t m = 0; m < count; m++) {
        const Vector e = minus(at(s->x, rows, g->odd_near[start + m]), x);
        const Vector next = minus(at(s->x, rows, g->odd_near[start + (m + 1) % count]), x), normal = cross(e, next);
        area += sqrt(dot(normal, normal)), length += sqrt(dot(e, e));
    }
    s->area[i] = area / (double)count, s->reach[i] = length / (double)count;
    s->along[i] = s->along[n + i] = length;
}

MESHONET_CLONES
double step_sizes(const Step *step, ptrdiff_t first, ptrdiff_t last)
{
    const Step s = *step;
    const Graph *g = s.graph;
    const ptrdiff_t n = g->nodes, rows = n + g->ghosts;
    const int *near = s.near;
    fill_ghosts(g, s.x, first, last, 0);
    MESHONET_INDEPENDENT
    for (ptrdiff_t i = first; i < last; i++) {
        const Vector x = at(s.x, rows, i);
        const Vector a = minus(at(s.x, rows, near[i]), x), b = minus(at(s.x, rows, near[n + i]), x);
        const Vector c = minus(at(s.x, rows, near[2 * n + i]), x), d = minus(at(s.x, rows, near[3 * n + i]), x);
        const Vector ab = cross(a, b), bc = cross(b, c), cd = cross(c, d), da = cross(d, a);
        const double xi = sqrt(dot(a, a)) + sqrt(dot(c, c)), eta = sqrt(dot(b, b)) + sqrt(dot(d, d));
        s.area[i] = 0.25 * (sqrt(dot(ab, ab)) + sqrt(dot(bc, bc)) + sqrt(dot(cd, cd)) + sqrt(dot(da, da)));
        s.reach[i] = 0.25 * (xi + eta), s.along[i] = xi, s.along[n + i] = eta;
    }
    for (ptrdiff_t k = first_from(g->odd_nodes, g->odd, first); k < g->odd && g->odd_nodes[k] < last; k++)
        odd_sizes(step, k);
    double shortest = s.reach[first];
    for (ptrdiff_t i = first + 1; i < last; i++)
        shortest = smaller(shortest, s.reach[i]);
    return shortest;
}

MESHONET_CLONES
double step_smooth(const Step *step, const double *values, double *out, double weight, ptrdiff_t first, ptrdiff_t last)
{
    const Graph *g = step->graph;
    const ptrdiff_t n = g->nodes;
    const int *near = step->near;
    MESHONET_INDEPENDENT
    for (ptrdiff_t i = first; i < last; i++)
        out[i] = (1.0 - weight) * values[i] + 0.25 * weight * (values[near[i]] + values[near[n + i]] +
                                                              values[near[2 * n + i]] + values[near[3 * n + i]]);
    for (ptrdiff_t k = first_from(g->odd_nodes, g->odd, first); k < g->odd && g->odd_nodes[k] < last; k++) {
        const ptrdiff_t i = g->odd_nodes[k], count = g->odd_start[k + 1] - g->odd_start[k];
        double around = 0.0;
        for (ptrdiff_t m = g->odd_start[k]; m < g->odd_start[k + 1]; m++)
            around += values[g->odd_near[m]];
        out[i] = (1.0 - weight) * values[i] + weight * around / (double)count;
    }
    return sum_of(out + first, last - first);
}
