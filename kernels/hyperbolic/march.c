/* Implicit hyperbolic marching, one level after another, from a closed wall or from wake, wall and wake.

   A new level r + dr solves, with the edges e- and e+ at a node, t the unit vector along their directions' sum,
   w their mean length, n = i t the normal (vectors as complex numbers), s the step and V = s w the cell's area,
       (I + (1 + theta) C d_xi - 2 eps D2) dr = n V/w + eps D2 r,      C v = t^2 i V/w^2 conj(v),
   which is area conservation x_xi y_eta - x_eta y_xi = V and orthogonality r_xi . r_eta = 0, linearised about
   the level below: Steger and Chaussee, SIAM J. Sci. Stat. Comput. 1 (1980) 431; areas smoothed along the level
   and dissipation that grows with the level, where lines converge and at concave nodes: Chan and Steger, Appl.
   Math. Comput. 51 (1992) 181. d_xi is the central difference; C is a symmetric 2x2 matrix without trace.
   D2 r = (c+ e+ - c- e-) is the second difference by arc length with c = w/|e|, which keeps uneven spacing; c = 1 evens it
   out at the price of angles. `even` is the weight of the latter; it is larger where neighbouring edges differ by more
   than `tolerated`, and more than on the wall. eps also has the smoothing bend s h/w², with the height h so far, without
   which fine grids focus lines at concave corners.

   The periodic block-tridiagonal system is solved by elimination without the last node, whose equation then closes it.
   Ends of open levels move along straight lines d: dr = d (d . dr of the neighbour). Levels of many nodes are eliminated
   from both ends to the middle, by two threads; the others share what is done node by node. */
#include "march.h"
#include "elementary.h"
#include "team.h"
#include <math.h>
#include <string.h>

/* Part of the levels over which higher first cells beside a wake even out; with more, lines crowd at the trailing edge. */
static const double OPENED = 0.5;
/* Part of the levels over which the smoothing of areas sets in; at the wall it would change first cells at kinks. */
static const double CALM = 0.25;
/* Growth of `even` per unit of excess difference of neighbouring edges. */
static const double EVENING = 15.0;

#define WIDE 1024 /* nodes of a level from which on it is eliminated from both ends, and worked on in blocks */
#define BLOCK 256 /* nodes of a loop, for equal rounding with any number of threads */

typedef struct {
    double a, b, c, d; /* a b / c d */
} Matrix;

MESHONET_INLINE Matrix product(Matrix p, Matrix q)
{
    return (Matrix){p.a * q.a + p.b * q.c, p.a * q.b + p.b * q.d, p.c * q.a + p.d * q.c, p.c * q.b + p.d * q.d};
}

MESHONET_INLINE Matrix difference(Matrix p, Matrix q)
{
    return (Matrix){p.a - q.a, p.b - q.b, p.c - q.c, p.d - q.d};
}

MESHONET_INLINE Matrix inverse(Matrix p)
{
    const double over = 1.0 / (p.a * p.d - p.b * p.c);
    return (Matrix){p.d * over, -p.b * over, -p.c * over, p.a * over};
}

/* Where the parts of the scratch begin; arrays marked halo have one value more at both ends. */
typedef struct {
    double *ex, *ey, *length;    /* halo: edges from node i to i + 1, and their lengths */
    double *volume, *smoothed;   /* halo */
    double *before;              /* sum of both edges at the node, on the level below */
    double *free;                /* relative difference of both edges that is left alone */
    double *p, *s, *rx, *ry;
    double *lower, *upper;       /* eps c- and eps c+ */
    double *bx, *by;             /* eliminated right side */
    Matrix *next, *last;         /* eliminated coefficients of the next and of the last node */
} March;

size_t hyperbolic_scratch(ptrdiff_t n)
{
    return (size_t)(5 * (n + 2) + 10 * n + 2 * 4 * n);
}

static March parts(double *scratch, ptrdiff_t n)
{
    March m;
    double **halo[] = {&m.ex, &m.ey, &m.length, &m.volume, &m.smoothed};
    double **plain[] = {&m.before, &m.free, &m.p, &m.s, &m.rx, &m.ry, &m.lower, &m.upper, &m.bx, &m.by};
    m.next = (Matrix *)scratch, m.last = m.next + n;
    scratch += 8 * n;
    for (int k = 0; k < 5; k++, scratch += n + 2)
        *halo[k] = scratch + 1;
    for (int k = 0; k < 10; k++, scratch += n)
        *plain[k] = scratch;
    return m;
}

MESHONET_INLINE void wrap(double *values, ptrdiff_t n, int closed)
{
    values[-1] = values[closed ? n - 1 : 0], values[n] = values[closed ? 0 : n - 1];
}

/* `count` smoothing steps of the areas along a level, the last one in part where that is not whole. */
MESHONET_INLINE void smooth_areas(const March *m, ptrdiff_t n, double count, double volume, int closed)
{
    double *from = m->volume, *to = m->smoothed;
    for (; count > 0.0; count -= 1.0) {
        const double weight = volume * fmin(count, 1.0), keep = 1.0 - weight, give = 0.5 * weight;
        wrap(from, n, closed);
        MESHONET_INDEPENDENT
        for (ptrdiff_t i = 0; i < n; i++)
            to[i] = keep * from[i] + give * (from[i - 1] + from[i + 1]);
        double *swap = from;
        from = to, to = swap;
    }
    if (from != m->volume)
        memcpy(m->volume, from, (size_t)n * sizeof *from);
}

/* Areas of cells whose step is `widening` to the power of `part` longer. */
MESHONET_INLINE void widen(const March *m, ptrdiff_t n, const double *widening, double part)
{
    if (widening == NULL || part <= 0.0)
        return;
    for (ptrdiff_t i = 0; i < n; i++)
        if (widening[i] != 1.0)
            m->volume[i] *= pow(widening[i], part);
}

/* The nodes of block k of a level. */
MESHONET_INLINE Range block_of(ptrdiff_t k, ptrdiff_t n)
{
    const ptrdiff_t each = n < WIDE ? n : BLOCK;
    return (Range){k * each, (k + 1) * each < n ? (k + 1) * each : n};
}

/* Unit edges and their lengths. */
MESHONET_INLINE void measure_edges(const March *m, const double *restrict x, const double *restrict y, ptrdiff_t n,
                                   Range own, int closed)
{
    double *restrict ex = m->ex, *restrict ey = m->ey, *restrict length = m->length;
    const int end = own.last == n && own.first < n;
    for (ptrdiff_t i = own.first; i < own.last - end; i++)
        ex[i] = x[i + 1] - x[i], ey[i] = y[i + 1] - y[i];
    if (end && closed)
        ex[n - 1] = x[0] - x[n - 1], ey[n - 1] = y[0] - y[n - 1];
    else if (end)
        ex[n - 1] = x[n - 1] - x[n - 2], ey[n - 1] = y[n - 1] - y[n - 2];
    for (ptrdiff_t i = own.first; i < own.last; i++) {
        length[i] = sqrt(ex[i] * ex[i] + ey[i] * ey[i]);
        ex[i] /= length[i], ey[i] /= length[i];
    }
}

/* The areas of the cells between this level and the next. */
MESHONET_INLINE void measure_areas(const March *m, ptrdiff_t n, double step, int closed)
{
    wrap(m->ex, n, closed), wrap(m->ey, n, closed), wrap(m->length, n, closed);
    for (ptrdiff_t i = 0; i < n; i++)
        m->volume[i] = 0.5 * step * (m->length[i] + m->length[i - 1]);
}

/* ratio^exponent between 0.1 and 50, for exponents of 2 or more, to 1e-12: the series of atanh and exp. */
MESHONET_INLINE double limited_power(double ratio, double exponent)
{
    const double root = sqrt(sqrt(sqrt(smaller(larger(ratio, 0.3), 8.0)))), z = (root - 1.0) / (root + 1.0), q = z * z;
    double log = 1.0 / 13.0, power = 1.0;
    for (int k = 11; k > 0; k -= 2)
        log = 1.0 / k + q * log;
    const double e = 0.0625 * smaller(larger(exponent * 16.0 * z * log, -2.302585092994046), 3.912023005428146);
    for (int k = 9; k > 0; k--)
        power = 1.0 + e / k * power;
    for (int k = 0; k < 4; k++)
        power *= power;
    return power;
}

/* Coefficients p, s of (1 + theta) C/2 = [p s / s -p], dissipation and the right side of every node.
   `growth` is sqrt(level / levels): the dissipation's, and in the exponent of the convergence of lines; `bend`
   the settings' times step and height. */
MESHONET_INLINE void assemble(const March *m, Range own, int first, double growth, double bend,
                              const MarchSettings *settings)
{
    const double *restrict ex = m->ex, *restrict ey = m->ey, *restrict length = m->length, *restrict v = m->volume;
    double *restrict before = m->before, *restrict let = m->free, *restrict lower = m->lower, *restrict upper = m->upper;
    double *restrict rx = m->rx, *restrict ry = m->ry, *restrict ps = m->p, *restrict ss = m->s;
    const double smooth = settings->dissipation * growth, exponent = 2.0 / growth, flux = 0.5 * settings->implicit;
    const double least_even = settings->even, tolerated = settings->tolerated;
    if (first)
        for (ptrdiff_t i = own.first; i < own.last; i++) {
            before[i] = length[i] + length[i - 1];
            let[i] = larger(fabs(length[i] - length[i - 1]) / smaller(length[i], length[i - 1]), tolerated);
        }
    MESHONET_INDEPENDENT
    for (ptrdiff_t i = own.first; i < own.last; i++) {
        const double ux = ex[i], uy = ey[i], both = length[i] + length[i - 1], w = 0.5 * both;
        const double apart = fabs(length[i] - length[i - 1]) / smaller(length[i], length[i - 1]);
        double tx = ux + ex[i - 1], ty = uy + ey[i - 1];
        const double over = 1.0 / sqrt(tx * tx + ty * ty);
        tx *= over, ty *= over;
        const double rate = v[i] / w, aspect = rate / w;
        const double concave = larger(tx * uy - ty * ux, 0.0); /* n . e+: where the wall bends towards the grid */
        const double sharp = concave > 0.0 ? smaller(1.0 / (1.0 - concave * concave + 1e-6), 20.0) : 1.0;
        const double eps = smooth * aspect * limited_power(before[i] / both, exponent) * sharp + bend / (w * w);
        before[i] = both;
        const double even = smaller(least_even + EVENING * larger(apart - let[i], 0.0), 1.0), arc = (1.0 - even) * w;
        const double weight = flux * aspect; /* half: d_xi is over two cells */
        ps[i] = -weight * 2.0 * tx * ty;
        ss[i] = weight * (tx * tx - ty * ty);
        /* second difference of r by edges, which keeps its digits where the cells are small */
        const double lp = eps * (even * length[i] + arc), lm = eps * (even * length[i - 1] + arc);
        upper[i] = 2.0 * lp / length[i], lower[i] = 2.0 * lm / length[i - 1];
        rx[i] = -ty * rate + lp * ux - lm * ex[i - 1];
        ry[i] = tx * rate + lp * uy - lm * ey[i - 1];
    }
}

/* The block row of a node: coefficients of the nodes before and behind it, and of its own. */
typedef struct {
    Matrix below, above, centre;
} BlockRow;

MESHONET_INLINE BlockRow block_row(const March *m, ptrdiff_t i)
{
    const double p = m->p[i], s = m->s[i], a = m->lower[i], c = m->upper[i];
    return (BlockRow){{-p - a, -s, -s, p - a}, {p - c, s, s, -p - c}, {1.0 + a + c, 0, 0, 1.0 + a + c}};
}

/* Eliminate nodes `from`, one `step` (1 or -1) after another, to before `to` of the k first of a closed level: what
   is left is dr = b - next dr of the node ahead - last dr of the bordering one. */
MESHONET_INLINE void eliminate_closed(const March *m, ptrdiff_t from, ptrdiff_t to, const int step, ptrdiff_t k)
{
    Matrix next = {0, 0, 0, 0}, last = next;
    double gx = 0, gy = 0;
    for (ptrdiff_t i = from; i != to; i += step) {
        const BlockRow row = block_row(m, i);
        const Matrix behind = step > 0 ? row.below : row.above, ahead = step > 0 ? row.above : row.below;
        Matrix centre = row.centre, border;
        double fx = m->rx[i], fy = m->ry[i];
        if (i == from) {
            border = behind;
        } else {
            const Matrix zero = {0, 0, 0, 0};
            centre = difference(centre, product(behind, next));
            border = difference(zero, product(behind, last));
            fx -= behind.a * gx + behind.b * gy, fy -= behind.c * gx + behind.d * gy;
        }
        if (step > 0 && i == k - 1)
            border.a += ahead.a, border.b += ahead.b, border.c += ahead.c, border.d += ahead.d;
        const Matrix over = inverse(centre);
        next = product(over, ahead), last = product(over, border);
        gx = over.a * fx + over.b * fy, gy = over.c * fx + over.d * fy;
        m->next[i] = next, m->last[i] = last, m->bx[i] = gx, m->by[i] = gy;
    }
}

/* Solve for node `middle`, where both eliminations meet, but for the bordering one. */
MESHONET_INLINE void join(const March *m, ptrdiff_t middle, int closed)
{
    const ptrdiff_t low = middle - 1;
    const Matrix one = {1.0, 0, 0, 1.0}, back = m->next[middle];
    const Matrix over = inverse(difference(one, product(back, m->next[low])));
    const double fx = m->bx[middle] - (back.a * m->bx[low] + back.b * m->by[low]);
    const double fy = m->by[middle] - (back.c * m->bx[low] + back.d * m->by[low]);
    m->bx[middle] = over.a * fx + over.b * fy, m->by[middle] = over.c * fx + over.d * fy;
    if (closed)
        m->last[middle] = product(over, difference(m->last[middle], product(back, m->last[low])));
}

/* Put in the nodes ahead, from that next to `from`, where they are known, to before `to`. */
MESHONET_INLINE void substitute_closed(const March *m, ptrdiff_t from, ptrdiff_t to, const int step)
{
    double *restrict bx = m->bx, *restrict by = m->by, gx = bx[from], gy = by[from];
    Matrix last = m->last[from];
    for (ptrdiff_t i = from + step; i != to; i += step) {
        const Matrix next = m->next[i];
        bx[i] -= next.a * gx + next.b * gy, by[i] -= next.c * gx + next.d * gy;
        gx = bx[i], gy = by[i];
        last = difference(m->last[i], product(next, last));
        m->last[i] = last;
    }
}

/* Add dr of a closed level to (x, y), giving (to_x, to_y), once the bordering node is known. */
MESHONET_INLINE void add_closed(const March *m, const double *restrict x, const double *restrict y, ptrdiff_t n,
                                Range own, double *restrict to_x, double *restrict to_y)
{
    const ptrdiff_t k = n - 1; /* the bordering node */
    const double *restrict bx = m->bx, *restrict by = m->by;
    const BlockRow row = block_row(m, k);
    const Matrix below = row.below, above = row.above;
    const Matrix centre = difference(difference(row.centre, product(below, m->last[k - 1])), product(above, m->last[0]));
    const double fx = m->rx[k] - (below.a * bx[k - 1] + below.b * by[k - 1]) - (above.a * bx[0] + above.b * by[0]);
    const double fy = m->ry[k] - (below.c * bx[k - 1] + below.d * by[k - 1]) - (above.c * bx[0] + above.d * by[0]);
    const Matrix over = inverse(centre);
    const double dx = over.a * fx + over.b * fy, dy = over.c * fx + over.d * fy;
    const ptrdiff_t end = own.last < k ? own.last : k;
    for (ptrdiff_t i = own.first; i < end; i++) {
        to_x[i] = x[i] + bx[i] - (m->last[i].a * dx + m->last[i].b * dy);
        to_y[i] = y[i] + by[i] - (m->last[i].c * dx + m->last[i].d * dy);
    }
    if (own.first <= k && own.last > k)
        to_x[k] = x[k] + dx, to_y[k] = y[k] + dy;
}

/* The same elimination for a level with two ends, from the one that moves along (ux, uy). */
MESHONET_INLINE void eliminate_open(const March *m, ptrdiff_t from, ptrdiff_t to, const int step, double ux, double uy)
{
    Matrix next = {-ux * ux, -ux * uy, -ux * uy, -uy * uy};
    double gx = 0, gy = 0;
    m->next[from] = next, m->bx[from] = m->by[from] = 0;
    for (ptrdiff_t i = from + step; i != to; i += step) {
        const BlockRow row = block_row(m, i);
        const Matrix behind = step > 0 ? row.below : row.above, ahead = step > 0 ? row.above : row.below;
        const Matrix over = inverse(difference(row.centre, product(behind, next)));
        const double rx = m->rx[i] - behind.a * gx - behind.b * gy, ry = m->ry[i] - behind.c * gx - behind.d * gy;
        next = product(over, ahead);
        gx = over.a * rx + over.b * ry, gy = over.c * rx + over.d * ry;
        m->next[i] = next, m->bx[i] = gx, m->by[i] = gy;
    }
}

/* dr of the last node is d (d . dr of the node before), which is g - next dr of the last one: along d one equation. */
MESHONET_INLINE void close_end(const March *m, ptrdiff_t n, double lx, double ly)
{
    const Matrix next = m->next[n - 2];
    const double along = lx * m->bx[n - 2] + ly * m->by[n - 2];
    const double share = lx * (next.a * lx + next.b * ly) + ly * (next.c * lx + next.d * ly);
    m->bx[n - 1] = lx * along / (1.0 + share), m->by[n - 1] = ly * along / (1.0 + share);
}

/* dr of the nodes from `from`, where it is known, to before `to`, added to (x, y). */
MESHONET_INLINE void add_open(const March *m, const double *restrict x, const double *restrict y, ptrdiff_t from,
                              ptrdiff_t to, const int step, double *restrict to_x, double *restrict to_y)
{
    double gx = m->bx[from], gy = m->by[from];
    for (ptrdiff_t i = from + step; i != to; i += step) {
        const Matrix next = m->next[i];
        const double dx = m->bx[i] - (next.a * gx + next.b * gy), dy = m->by[i] - (next.c * gx + next.d * gy);
        to_x[i] = x[i] + dx, to_y[i] = y[i] + dy;
        gx = dx, gy = dy;
    }
}

/* A march that a team works on. */
typedef struct {
    double *x, *y;
    ptrdiff_t n, levels;
    const double *steps, *widening, *ratios;
    const MarchEnds *ends;
    const MarchSettings *settings;
    March parts;
} Task;

/* A level solved for from its own block rows, by the first thread from below and by the last from above. */
MESHONET_INLINE void solve_closed(const Task *t, Member member, Range own, double *x, double *y)
{
    const March *m = &t->parts;
    const ptrdiff_t n = t->n, k = n - 1, middle = n < WIDE ? k : k / 2, known = middle < k ? middle : k - 1;
    const int first = member.rank == 0, last = member.rank == member.size - 1;
    if (first)
        eliminate_closed(m, 0, middle, 1, k);
    if (last && middle < k)
        eliminate_closed(m, k - 1, middle - 1, -1, k);
    team_wait(member);
    if (first && middle < k)
        join(m, middle, 1);
    team_wait(member);
    if (first)
        substitute_closed(m, known, -1, -1);
    if (last && middle < k)
        substitute_closed(m, known, k, 1);
    team_wait(member);
    for (ptrdiff_t k = own.first; k < own.last; k++)
        add_closed(m, x, y, n, block_of(k, n), x + n, y + n);
}

MESHONET_INLINE void solve_open(const Task *t, Member member, double *x, double *y)
{
    const March *m = &t->parts;
    const MarchEnds *ends = t->ends;
    const ptrdiff_t n = t->n, middle = n < WIDE ? n - 1 : n / 2;
    const int first = member.rank == 0, last = member.rank == member.size - 1;
    if (first)
        eliminate_open(m, 0, middle, 1, ends->first_x, ends->first_y);
    if (last && middle < n - 1)
        eliminate_open(m, n - 1, middle - 1, -1, ends->last_x, ends->last_y);
    team_wait(member);
    if (first && middle < n - 1)
        join(m, middle, 0);
    else if (first)
        close_end(m, n, ends->last_x, ends->last_y);
    team_wait(member);
    double *to_x = x + n, *to_y = y + n;
    if (first) {
        to_x[middle] = x[middle] + m->bx[middle], to_y[middle] = y[middle] + m->by[middle];
        add_open(m, x, y, middle, -1, -1, to_x, to_y);
    }
    if (last && middle < n - 1)
        add_open(m, x, y, middle, n, 1, to_x, to_y);
}

MESHONET_CLONES
static void march(void *data, Member member)
{
    const Task *t = data;
    const March m = t->parts;
    const MarchSettings *settings = t->settings;
    const ptrdiff_t n = t->n, levels = t->levels;
    const int closed = t->ends == NULL;
    double *x = t->x, *y = t->y;
    double height = 0.0;
    const Range own = team_share(n < WIDE ? 1 : (n + BLOCK - 1) / BLOCK, member); /* blocks */
    for (ptrdiff_t level = 0; level < levels; level++, x += n, y += n) {
        const double step = t->steps[level];
        const ptrdiff_t risen = level + 1 < settings->rise ? level + 1 : settings->rise;
        const double growth = sqrt((double)risen / (double)levels);
        for (ptrdiff_t k = own.first; k < own.last; k++)
            measure_edges(&m, x, y, n, block_of(k, n), closed);
        team_wait(member);
        if (member.rank == 0) {
            const double calm = fmin((double)level / (CALM * (double)levels), 1.0);
            measure_areas(&m, n, step, closed);
            widen(&m, n, t->widening, 1.0 - (double)level / (OPENED * (double)levels));
            widen(&m, n, t->ratios, (double)level);
            smooth_areas(&m, n, calm * (double)settings->sweeps, settings->volume, closed);
        }
        team_wait(member);
        height += step;
        for (ptrdiff_t k = own.first; k < own.last; k++)
            assemble(&m, block_of(k, n), level == 0, growth, settings->bend * step * height, settings);
        team_wait(member);
        if (closed)
            solve_closed(t, member, own, x, y);
        else
            solve_open(t, member, x, y);
        team_wait(member);
    }
}

void hyperbolic_march(double *x, double *y, ptrdiff_t n, ptrdiff_t levels, const double *steps, const double *widening,
                      const double *ratios, const MarchEnds *ends, const MarchSettings *settings, int threads,
                      double *scratch)
{
    Task task = {x, y, n, levels, steps, widening, ratios, ends, settings, parts(scratch, n)};
    team_run(n < WIDE ? 1 : threads, march, &task);
}
