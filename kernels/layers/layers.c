/* Nodes moved along grid lines into layers.

   The steps d_k, k = 0 .. m-1, of a line grow by one ratio from each end that asks for a height:

       ln d_k = (1 - w_k) ln first + w_k ln last + l min(k - a, b - k)     a < k < b,  w_k = (k - a)/(b - a)

   with the first steps 0 .. a and the last b .. m-1 constant. l is found such that the steps add up to the length of
   the line. With one end only  ln d_k = ln first + l (k - a). */
#include "layers.h"
#include "clones.h"
#include "team.h"
#include <math.h>

#define TOGETHER 512 /* lines that one thread takes one after the other, so that laws begin from those before */

/* A grid line as a curve: cubic Hermite pieces between its nodes, tangents those of parabolas through three nodes. */
typedef struct {
    double *arc, *px, *py, *dx, *dy; /* (nj): arc length, nodes and unit tangents of a line as it was */
} Line;

MESHONET_INLINE void measure_line(const Line *line, const double *restrict x, const double *restrict y, ptrdiff_t nj)
{
    double *restrict arc = line->arc, *restrict dx = line->dx, *restrict dy = line->dy;
    arc[0] = 0.0;
    double before = 0, ux = 0, uy = 0;
    for (ptrdiff_t j = 0; j < nj; j++) {
        line->px[j] = x[j], line->py[j] = y[j];
        if (j == nj - 1) {
            dx[j] = ux, dy[j] = uy;
            break;
        }
        double vx = x[j + 1] - x[j], vy = y[j + 1] - y[j];
        const double length = sqrt(vx * vx + vy * vy), over = 1.0 / (before + length);
        vx /= length, vy /= length;
        arc[j + 1] = arc[j] + length;
        if (j > 0)
            dx[j] = (ux * length + vx * before) * over, dy[j] = (uy * length + vy * before) * over;
        if (j == 1) /* the parabola through the first three nodes, at the first */
            dx[0] = ux + (ux - vx) * before * over, dy[0] = uy + (uy - vy) * before * over;
        before = length, ux = vx, uy = vy;
    }
}

/* Let the last tangent be that of the parabola through the last three nodes too. */
MESHONET_INLINE void measure_end(const Line *line, ptrdiff_t nj)
{
    const ptrdiff_t k = nj - 1;
    const double h = line->arc[k] - line->arc[k - 1], before = line->arc[k - 1] - line->arc[k - 2];
    const double ux = (line->px[k] - line->px[k - 1]) / h, uy = (line->py[k] - line->py[k - 1]) / h;
    const double vx = (line->px[k - 1] - line->px[k - 2]) / before, vy = (line->py[k - 1] - line->py[k - 2]) / before;
    line->dx[k] = ux + (ux - vx) * h / (before + h), line->dy[k] = uy + (uy - vy) * h / (before + h);
}

/* Displacement from node k of the point at arc length t behind it, within the piece that begins there. */
MESHONET_INLINE void displacement(const Line *line, ptrdiff_t k, double t, double *x, double *y)
{
    const double h = line->arc[k + 1] - line->arc[k], q = (t - line->arc[k]) / h, r = 1.0 - q;
    const double b = q * r * r * h, c = q * q * (3.0 - 2.0 * q), d = -q * q * r * h;
    *x = b * line->dx[k] + c * (line->px[k + 1] - line->px[k]) + d * line->dx[k + 1];
    *y = b * line->dy[k] + c * (line->py[k + 1] - line->py[k]) + d * line->dy[k + 1];
}

/* The piece in which arc length t lies, sought from piece k on. */
MESHONET_INLINE ptrdiff_t piece(const Line *line, ptrdiff_t k, double t, ptrdiff_t nj)
{
    while (k < nj - 2 && line->arc[k + 1] < t)
        k++;
    return k;
}

/* The point at arc length t; piece *k or a later one begins before it, and takes its number. */
MESHONET_INLINE void point_at(const Line *line, ptrdiff_t *k, double t, ptrdiff_t nj, double *x, double *y)
{
    double dx, dy;
    *k = piece(line, *k, t, nj);
    displacement(line, *k, t, &dx, &dy);
    *x = line->px[*k] + dx, *y = line->py[*k] + dy;
}

/* The arc length at which a line is `first` away from its first node, less than half of it. */
MESHONET_INLINE double place_of_first(const Line *line, double first, ptrdiff_t nj)
{
    double t = first, x, y;
    for (int pass = 0; pass < 8; pass++) {
        const ptrdiff_t k = piece(line, 0, t, nj);
        displacement(line, k, t, &x, &y);
        x += line->px[k] - line->px[0], y += line->py[k] - line->py[0];
        const double ratio = first / sqrt(x * x + y * y);
        t *= ratio;
        if (fabs(ratio - 1.0) < 1e-14)
            break;
    }
    return t;
}

/* One law: where its constant parts end, and the slopes of ln d in between, without and with l. */
typedef struct {
    ptrdiff_t a, b, cells;
    double first, last, drift;
} Law;

static Law law_of(const Layers *layers, double first, double last, ptrdiff_t cells)
{
    Law w = {0, cells - 1, cells, first, last, 0.0};
    if (first > 0.0)
        w.a = layers->constant - 1;
    if (last > 0.0)
        w.b = cells - layers->constant;
    if (first > 0.0 && last > 0.0)
        w.drift = w.b > w.a ? (log(last) - log(first)) / (double)(w.b - w.a) : 0.0;
    return w;
}

/* Fill steps for l; return their sum and its derivative by l. */
static double fill(const Law *w, double l, double *steps, double *slope)
{
    double sum = 0.0, rise = 0.0;
    if (w->first > 0.0 && w->last > 0.0) {
        const ptrdiff_t middle = (w->a + w->b) / 2;
        const double up = exp(w->drift + l), down = exp(l - w->drift);
        double d = w->first;
        for (ptrdiff_t k = 0; k <= middle && k < w->cells; k++) {
            const ptrdiff_t t = k > w->a ? k - w->a : 0;
            if (t > 0)
                d *= up;
            steps[k] = d, sum += d, rise += (double)t * d;
        }
        d = w->last;
        for (ptrdiff_t k = w->cells - 1; k > middle; k--) {
            const ptrdiff_t t = k < w->b ? w->b - k : 0;
            if (t > 0)
                d *= down;
            steps[k] = d, sum += d, rise += (double)t * d;
        }
    } else {
        const int south = w->first > 0.0;
        const double ratio = exp(l);
        const ptrdiff_t constant = south ? w->a + 1 : w->cells - w->b;
        double d = south ? w->first : w->last;
        for (ptrdiff_t k = 0; k < w->cells; k++) {
            if (k >= constant)
                d *= ratio;
            steps[south ? k : w->cells - 1 - k] = d, sum += d;
            rise += k >= constant ? (double)(k - constant + 1) * d : 0.0;
        }
    }
    *slope = rise;
    return sum;
}

static double solve_law(const Law *w, double length, double *steps, double *log_ratio)
{
    double l = *log_ratio, low = -3.0, high = 3.0, slope;
    if (!(l > low && l < high))
        l = 0.0;
    for (int pass = 0; pass < 100; pass++) {
        const double sum = fill(w, l, steps, &slope), miss = log(sum / length);
        if (fabs(miss) < 4e-16 * (double)w->cells || high - low < 1e-15)
            break;
        if (miss > 0.0 || !(sum < 1e300))
            high = l;
        else
            low = l;
        const double next = l - miss * sum / slope;
        l = next > low && next < high ? next : 0.5 * (low + high);
    }
    *log_ratio = l;
    const double reach = fabs(l) + fabs(w->drift), sum = fill(w, l, steps, &slope);
    if (!(fabs(sum / length - 1.0) < 1e-9))
        return INFINITY;
    return exp(reach);
}

double layer_steps(double *steps, ptrdiff_t cells, double length, const Layers *layers, double *log_ratio)
{
    const Law w = law_of(layers, layers->first, layers->last, cells);
    return solve_law(&w, length, steps, log_ratio);
}

/* The line run through the other way round. */
static void reverse(const Line *line, const Line *back, ptrdiff_t nj)
{
    const double length = line->arc[nj - 1];
    for (ptrdiff_t j = 0, k = nj - 1; j < nj; j++, k--) {
        back->arc[j] = length - line->arc[k];
        back->px[j] = line->px[k], back->py[j] = line->py[k];
        back->dx[j] = -line->dx[k], back->dy[j] = -line->dy[k];
    }
}

/* What a team samples anew, and the largest ratio of each thread. */
typedef struct {
    const double *x, *y;
    ptrdiff_t ni, nj, NJ;
    double *X, *Y, *scratch;
    const Layers *layers;
    double largest[TEAM_MOST];
} Sampling;

/* Lines `i` to before `end`, the law of each begun from that of the line before. */
MESHONET_CLONES
static double sample_lines(const Sampling *all, ptrdiff_t i, ptrdiff_t end, double *scratch)
{
    const ptrdiff_t nj = all->nj, NJ = all->NJ;
    const Layers *layers = all->layers;
    const Line line = {scratch, scratch + nj, scratch + 2 * nj, scratch + 3 * nj, scratch + 4 * nj};
    double *s = scratch + 5 * nj, *steps = scratch + 10 * nj, log_ratio = 0.0, largest = 1.0;
    const Line back = {s, s + nj, s + 2 * nj, s + 3 * nj, s + 4 * nj};
    for (; i < end; i++) {
        const double *x = all->x + i * nj, *y = all->y + i * nj;
        double *X = all->X + i * NJ, *Y = all->Y + i * NJ;
        measure_line(&line, x, y, nj);
        measure_end(&line, nj);
        reverse(&line, &back, nj);
        const double first = layers->first > 0.0 ? place_of_first(&line, layers->first, nj) : 0.0;
        const double last = layers->last > 0.0 ? place_of_first(&back, layers->last, nj) : 0.0;
        const Law w = law_of(layers, first, last, NJ - 1);
        const double ratio = solve_law(&w, line.arc[nj - 1], steps, &log_ratio);
        largest = ratio > largest ? ratio : largest;
        const ptrdiff_t middle = NJ / 2;
        X[0] = x[0], Y[0] = y[0], X[NJ - 1] = x[nj - 1], Y[NJ - 1] = y[nj - 1];
        double t = 0.0;
        for (ptrdiff_t j = 1, k = 0; j < middle; j++) {
            t += steps[j - 1];
            point_at(&line, &k, t, nj, X + j, Y + j);
        }
        t = 0.0;
        for (ptrdiff_t j = NJ - 2, k = 0; j >= middle && j > 0; j--) {
            t += steps[j];
            point_at(&back, &k, t, nj, X + j, Y + j);
        }
    }
    return largest;
}

static void sample_share(void *data, Member member)
{
    Sampling *all = data;
    double largest = 1.0;
    const Range mine = team_share((all->ni + TOGETHER - 1) / TOGETHER, member);
    for (ptrdiff_t k = mine.first; k < mine.last; k++) {
        const ptrdiff_t end = TOGETHER * (k + 1) < all->ni ? TOGETHER * (k + 1) : all->ni;
        const double ratio = sample_lines(all, TOGETHER * k, end, all->scratch + member.rank * (10 * all->nj + all->NJ));
        largest = ratio > largest ? ratio : largest;
    }
    all->largest[member.rank] = largest;
}

double layer_lines(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, double *X, double *Y, ptrdiff_t NJ,
                   const Layers *layers, int threads, double *scratch)
{
    Sampling all = {x, y, ni, nj, NJ, X, Y, scratch, layers, {0.0}};
    double largest = 1.0;
    team_run(threads, sample_share, &all);
    for (int k = 0; k < TEAM_MOST; k++)
        largest = all.largest[k] > largest ? all.largest[k] : largest;
    return largest;
}

/* What a team moves. */
typedef struct {
    double *x, *y, *scratch;
    ptrdiff_t ni, nj;
    const double *first, *fade;
} Moving;

/* The arc lengths A_j of a line become T_j = A_j (1 + (c - 1) fade_j), where c is found such that nodes 0 and 1 end up
   `first[i]` apart. */
MESHONET_CLONES
static void move_lines(const Moving *all, ptrdiff_t start, ptrdiff_t end, double *scratch)
{
    const ptrdiff_t nj = all->nj;
    const Line line = {scratch, scratch + nj, scratch + 2 * nj, scratch + 3 * nj, scratch + 4 * nj};
    for (ptrdiff_t i = start; i < end; i++) {
        double *x = all->x + i * nj, *y = all->y + i * nj;
        measure_line(&line, x, y, nj);
        const double more = place_of_first(&line, all->first[i], nj) / line.arc[1] - 1.0;
        ptrdiff_t k = 0;
        for (ptrdiff_t j = 1; j < nj - 1; j++) {
            const double t = line.arc[j] * (1.0 + more * all->fade[j]);
            point_at(&line, &k, t, nj, x + j, y + j);
        }
    }
}

static void move_share(void *data, Member member)
{
    const Moving *all = data;
    const Range mine = team_share(all->ni, member);
    move_lines(all, mine.first, mine.last, all->scratch + member.rank * 5 * all->nj);
}

void redistribute_lines(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const double *first, const double *fade,
                        int threads, double *scratch)
{
    Moving all = {x, y, scratch, ni, nj, first, fade};
    team_run(threads, move_share, &all);
}
