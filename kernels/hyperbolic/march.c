/* Implicit hyperbolic marching, one level after another, from a closed wall or from wake, wall and wake.

   A new level r + dr solves, with the edges e- and e+ at a node, t the unit vector along their directions' sum,
   w their mean length, n = i t the normal (vectors as complex numbers), s the step and V = s w the cell's area,
       (I + (1 + theta) C d_xi - 2 eps D2) dr = n V/w + eps D2 r,      C v = t^2 i V/w^2 conj(v),
   which is area conservation x_xi y_eta - x_eta y_xi = V and orthogonality r_xi . r_eta = 0, linearised about
   the level below: Steger and Chaussee, SIAM J. Sci. Stat. Comput. 1 (1980) 431; areas smoothed along the level
   and dissipation that grows with the level, where lines converge and at concave nodes: Chan and Steger, Appl.
   Math. Comput. 51 (1992) 181. d_xi is the central difference; C is a symmetric 2x2 matrix without trace.
   D2 r = (c+ e+ - c- e-), with c = w/|e|, is the second difference along arc length: curvature, which lets uneven
   spacing be. Between that and c = 1, which evens spacing out at the price of angles, `even` says how much of
   either; more where neighbouring edges differ by more than `tolerated`, and than they do on the wall, as happens
   where lines that leave a hollow spread. To eps comes a smoothing as wide as levels are high, bend s h/w² with h the height so far, without
   which fine grids focus lines at concave corners: the others fade as cells become narrower. The periodic block-tridiagonal system is solved by elimination without the last node, whose
   equation then closes it. Levels that do not close have ends that move along straight lines d:
   dr = d (d . dr of the neighbour). */
#include "march.h"
#include "clones.h"
#include <math.h>
#include <string.h>

/* The part of the levels over which higher first cells beside a wake even out: later, the front would rise along the
   wake, and the lines that leave it lean towards the trailing edge and crowd there. */
static const double OPENED = 0.5;
/* The part of the levels over which the smoothing of areas sets in: next to the wall it would only change the heights
   of the first cells where the spacing along the wall has a kink. */
static const double CALM = 0.25;
/* What `even` grows by for each unit that neighbouring edges differ too much. */
static const double EVENING = 15.0;

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

/* Unit edges, their lengths, and the areas of the cells between this level and the next. */
MESHONET_INLINE void measure_level(const March *m, const double *restrict x, const double *restrict y, ptrdiff_t n,
                                   double step, int closed)
{
    double *restrict ex = m->ex, *restrict ey = m->ey, *restrict length = m->length;
    for (ptrdiff_t i = 0; i < n - 1; i++)
        ex[i] = x[i + 1] - x[i], ey[i] = y[i + 1] - y[i];
    if (closed)
        ex[n - 1] = x[0] - x[n - 1], ey[n - 1] = y[0] - y[n - 1];
    else
        ex[n - 1] = x[n - 1] - x[n - 2], ey[n - 1] = y[n - 1] - y[n - 2];
    for (ptrdiff_t i = 0; i < n; i++) {
        length[i] = sqrt(ex[i] * ex[i] + ey[i] * ey[i]);
        ex[i] /= length[i], ey[i] /= length[i];
    }
    wrap(ex, n, closed), wrap(ey, n, closed), wrap(length, n, closed);
    for (ptrdiff_t i = 0; i < n; i++)
        m->volume[i] = 0.5 * step * (length[i] + length[i - 1]);
}

MESHONET_INLINE double least(double a, double b)
{
    return a < b ? a : b; /* one instruction, and vectorised, unlike fmin */
}

MESHONET_INLINE double most(double a, double b)
{
    return a > b ? a : b;
}

/* ratio^exponent between 0.1 and 50, for exponents of 2 or more, to 1e-12: the series of atanh and exp. */
MESHONET_INLINE double limited_power(double ratio, double exponent)
{
    const double root = sqrt(sqrt(sqrt(least(most(ratio, 0.3), 8.0)))), z = (root - 1.0) / (root + 1.0), q = z * z;
    double log = 1.0 / 13.0, power = 1.0;
    for (int k = 11; k > 0; k -= 2)
        log = 1.0 / k + q * log;
    const double e = 0.0625 * least(most(exponent * 16.0 * z * log, -2.302585092994046), 3.912023005428146);
    for (int k = 9; k > 0; k--)
        power = 1.0 + e / k * power;
    for (int k = 0; k < 4; k++)
        power *= power;
    return power;
}

/* Coefficients p, s of (1 + theta) C/2 = [p s / s -p], dissipation and the right side of every node.
   `growth` is sqrt(level / levels): the dissipation's, and in the exponent of the convergence of lines; `bend`
   the settings' times step and height. */
MESHONET_INLINE void assemble(const March *m, ptrdiff_t n, int first, double growth, double bend,
                              const MarchSettings *settings)
{
    const double *restrict ex = m->ex, *restrict ey = m->ey, *restrict length = m->length, *restrict v = m->volume;
    double *restrict before = m->before, *restrict let = m->free, *restrict lower = m->lower, *restrict upper = m->upper;
    double *restrict rx = m->rx, *restrict ry = m->ry, *restrict ps = m->p, *restrict ss = m->s;
    const double smooth = settings->dissipation * growth, exponent = 2.0 / growth, flux = 0.5 * settings->implicit;
    const double least_even = settings->even, tolerated = settings->tolerated;
    if (first)
        for (ptrdiff_t i = 0; i < n; i++) {
            before[i] = length[i] + length[i - 1];
            let[i] = most(fabs(length[i] - length[i - 1]) / least(length[i], length[i - 1]), tolerated);
        }
    MESHONET_INDEPENDENT
    for (ptrdiff_t i = 0; i < n; i++) {
        const double ux = ex[i], uy = ey[i], both = length[i] + length[i - 1], w = 0.5 * both;
        const double apart = fabs(length[i] - length[i - 1]) / least(length[i], length[i - 1]);
        double tx = ux + ex[i - 1], ty = uy + ey[i - 1];
        const double over = 1.0 / sqrt(tx * tx + ty * ty);
        tx *= over, ty *= over;
        const double rate = v[i] / w, aspect = rate / w;
        const double concave = most(tx * uy - ty * ux, 0.0); /* n . e+: where the wall bends towards the grid */
        const double sharp = concave > 0.0 ? least(1.0 / (1.0 - concave * concave + 1e-6), 20.0) : 1.0;
        const double eps = smooth * aspect * limited_power(before[i] / both, exponent) * sharp + bend / (w * w);
        before[i] = both;
        const double even = least(least_even + EVENING * most(apart - let[i], 0.0), 1.0), arc = (1.0 - even) * w;
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

/* Solve for dr of a closed level and add it to (x, y), giving (to_x, to_y). */
MESHONET_INLINE void solve_closed(const March *m, const double *restrict x, const double *restrict y, ptrdiff_t n,
                                 double *restrict to_x, double *restrict to_y)
{
    const ptrdiff_t k = n - 1; /* the bordering node */
    double *restrict bx = m->bx, *restrict by = m->by;
    Matrix next = {0, 0, 0, 0}, last = next;
    double gx = 0, gy = 0;
    for (ptrdiff_t i = 0; i < k; i++) {
        const double p = m->p[i], s = m->s[i], a = m->lower[i], c = m->upper[i];
        const Matrix below = {-p - a, -s, -s, p - a}, above = {p - c, s, s, -p - c};
        Matrix centre = {1.0 + a + c, 0, 0, 1.0 + a + c}, border;
        double fx = m->rx[i], fy = m->ry[i];
        if (i == 0) {
            border = below;
        } else {
            const Matrix zero = {0, 0, 0, 0};
            centre = difference(centre, product(below, next));
            border = difference(zero, product(below, last));
            fx -= below.a * gx + below.b * gy, fy -= below.c * gx + below.d * gy;
        }
        if (i == k - 1)
            border.a += above.a, border.b += above.b, border.c += above.c, border.d += above.d;
        const Matrix over = inverse(centre);
        next = product(over, above), last = product(over, border);
        gx = over.a * fx + over.b * fy, gy = over.c * fx + over.d * fy;
        m->next[i] = next, m->last[i] = last, bx[i] = gx, by[i] = gy;
    }
    for (ptrdiff_t i = k - 2; i >= 0; i--) {
        next = m->next[i];
        bx[i] -= next.a * gx + next.b * gy, by[i] -= next.c * gx + next.d * gy;
        gx = bx[i], gy = by[i];
        last = difference(m->last[i], product(next, last));
        m->last[i] = last;
    }
    const double p = m->p[k], s = m->s[k], a = m->lower[k], c = m->upper[k];
    const Matrix below = {-p - a, -s, -s, p - a}, above = {p - c, s, s, -p - c};
    Matrix centre = {1.0 + a + c, 0, 0, 1.0 + a + c};
    centre = difference(difference(centre, product(below, m->last[k - 1])), product(above, m->last[0]));
    const double fx = m->rx[k] - (below.a * bx[k - 1] + below.b * by[k - 1]) - (above.a * bx[0] + above.b * by[0]);
    const double fy = m->ry[k] - (below.c * bx[k - 1] + below.d * by[k - 1]) - (above.c * bx[0] + above.d * by[0]);
    const Matrix over = inverse(centre);
    const double dx = over.a * fx + over.b * fy, dy = over.c * fx + over.d * fy;
    for (ptrdiff_t i = 0; i < k; i++) {
        to_x[i] = x[i] + bx[i] - (m->last[i].a * dx + m->last[i].b * dy);
        to_y[i] = y[i] + by[i] - (m->last[i].c * dx + m->last[i].d * dy);
    }
    to_x[k] = x[k] + dx, to_y[k] = y[k] + dy;
}

/* The same for a level with two ends. */
MESHONET_INLINE void solve_open(const March *m, const double *restrict x, const double *restrict y, ptrdiff_t n,
                                const MarchEnds *ends, double *restrict to_x, double *restrict to_y)
{
    double *restrict bx = m->bx, *restrict by = m->by;
    const double fx = ends->first_x, fy = ends->first_y, lx = ends->last_x, ly = ends->last_y;
    Matrix next = {-fx * fx, -fx * fy, -fx * fy, -fy * fy};
    double gx = 0, gy = 0;
    m->next[0] = next, bx[0] = by[0] = 0;
    for (ptrdiff_t i = 1; i < n - 1; i++) {
        const double p = m->p[i], s = m->s[i], a = m->lower[i], c = m->upper[i];
        const Matrix below = {-p - a, -s, -s, p - a}, above = {p - c, s, s, -p - c};
        const Matrix centre = {1.0 + a + c, 0, 0, 1.0 + a + c};
        const Matrix over = inverse(difference(centre, product(below, next)));
        const double rx = m->rx[i] - below.a * gx - below.b * gy, ry = m->ry[i] - below.c * gx - below.d * gy;
        next = product(over, above);
        gx = over.a * rx + over.b * ry, gy = over.c * rx + over.d * ry;
        m->next[i] = next, bx[i] = gx, by[i] = gy;
    }
    /* d (d . dr) of the node before, which is g - next dr of the last one: along d that is one equation */
    const double along = lx * gx + ly * gy;
    const double share = lx * (next.a * lx + next.b * ly) + ly * (next.c * lx + next.d * ly);
    gx = lx * along / (1.0 + share), gy = ly * along / (1.0 + share);
    to_x[n - 1] = x[n - 1] + gx, to_y[n - 1] = y[n - 1] + gy;
    for (ptrdiff_t i = n - 2; i >= 0; i--) {
        next = m->next[i];
        const double dx = bx[i] - (next.a * gx + next.b * gy), dy = by[i] - (next.c * gx + next.d * gy);
        to_x[i] = x[i] + dx, to_y[i] = y[i] + dy;
        gx = dx, gy = dy;
    }
}

MESHONET_CLONES
void hyperbolic_march(double *x, double *y, ptrdiff_t n, ptrdiff_t levels, const double *steps, const double *widening,
                      const double *ratios, const MarchEnds *ends, const MarchSettings *settings, double *scratch)
{
    const March m = parts(scratch, n);
    double height = 0.0;
    for (ptrdiff_t level = 0; level < levels; level++, x += n, y += n) {
        const ptrdiff_t risen = level + 1 < settings->rise ? level + 1 : settings->rise;
        const double growth = sqrt((double)risen / (double)levels);
        const double opened = 1.0 - (double)level / (OPENED * (double)levels);
        measure_level(&m, x, y, n, steps[level], ends == NULL);
        widen(&m, n, widening, opened);
        widen(&m, n, ratios, (double)level);
        const double calm = fmin((double)level / (CALM * (double)levels), 1.0);
        smooth_areas(&m, n, calm * (double)settings->sweeps, settings->volume, ends == NULL);
        height += steps[level];
        assemble(&m, n, level == 0, growth, settings->bend * steps[level] * height, settings);
        if (ends)
            solve_open(&m, x, y, n, ends, x + n, y + n);
        else
            solve_closed(&m, x, y, n, x + n, y + n);
    }
}
