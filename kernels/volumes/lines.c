/* Nodes moved along their lines, so that the cells at the ends have the heights that faces ask for. */
#include "lines.h"
#include "clones.h"
#include "team.h"
#include <math.h>

typedef struct {
    double *nodes;
    ptrdiff_t before, n, after;
    const double *low, *high;
    double reach;
} Lines;

enum { ROWS = 8 }; /* a line's x, y, z, arc length, steps, shares of the change; its new x; spare */

/* Change the steps at both ends, and distribute the rest of the length over steps that change little. */
static void change_steps(const Lines *l, double *steps, double *share, double length, double first, double last)
{
    const ptrdiff_t cells = l->n - 1;
    const double a = first > 0.0 ? log(first / steps[0]) : 0.0, b = last > 0.0 ? log(last / steps[cells - 1]) : 0.0;
    double sum = 0.0, free_sum = 0.0;
    for (ptrdiff_t k = 0; k < cells; k++) {
        const double from_first = first > 0.0 ? exp(-(double)k / l->reach) : 0.0;
        const double from_last = last > 0.0 ? exp(-(double)(cells - 1 - k) / l->reach) : 0.0;
        steps[k] *= exp(a * from_first + b * from_last);
        share[k] = steps[k] * (1.0 - from_first) * (1.0 - from_last);
        sum += steps[k], free_sum += share[k];
    }
    const double factor = free_sum > 0.0 ? (length - sum) / free_sum : 0.0;
    for (ptrdiff_t k = 0; k < cells; k++) /* keeps steps positive */
        steps[k] = factor > -0.9 ? steps[k] + factor * share[k] : steps[k] * length / sum;
}

/* Derivative by arc length at node k, of the parabola through its neighbours. */
MESHONET_INLINE double slope(const double *x, const double *s, ptrdiff_t k, ptrdiff_t n)
{
    const ptrdiff_t m = k == 0 ? 1 : k == n - 1 ? n - 2 : k;
    const double h = s[m] - s[m - 1], g = s[m + 1] - s[m], p = (x[m] - x[m - 1]) / h, q = (x[m + 1] - x[m]) / g;
    const double middle = (p * g + q * h) / (h + g);
    return k == m ? middle : k == 0 ? 2.0 * p - middle : 2.0 * q - middle;
}

static void respace(const Lines *l, double *x, ptrdiff_t plane, double first, double last, double *room)
{
    const ptrdiff_t n = l->n, stride = l->after;
    double *line[3] = {room, room + n, room + 2 * n}, *s = room + 3 * n, *steps = s + n, *share = steps + n;
    for (int c = 0; c < 3; c++)
        for (ptrdiff_t k = 0; k < n; k++)
            line[c][k] = x[c * plane + k * stride];
    s[0] = 0.0;
    for (ptrdiff_t k = 0; k < n - 1; k++) {
        const double dx = line[0][k + 1] - line[0][k], dy = line[1][k + 1] - line[1][k], dz = line[2][k + 1] - line[2][k];
        steps[k] = sqrt(dx * dx + dy * dy + dz * dz);
        s[k + 1] = s[k] + steps[k];
        if (!(steps[k] > 0.0))
            return;
    }
    change_steps(l, steps, share, s[n - 1], first, last);
    double at = 0.0;
    for (ptrdiff_t k = 1, near = 0; k < n - 1; k++) {
        at += steps[k - 1];
        while (near < n - 2 && s[near + 1] < at)
            near++;
        const double h = s[near + 1] - s[near], t = (at - s[near]) / h, u = 1.0 - t;
        for (int c = 0; c < 3; c++) {
            const double *v = line[c], d0 = h * slope(v, s, near, n), d1 = h * slope(v, s, near + 1, n);
            x[c * plane + k * stride] = u * u * (1.0 + 2.0 * t) * v[near] + t * t * (1.0 + 2.0 * u) * v[near + 1] +
                                        t * u * (u * d0 - t * d1);
        }
    }
    for (int end = 0; end < 2; end++) { /* prescribed lengths are those of chords */
        const double wanted = end ? last : first;
        const ptrdiff_t from = end ? n - 1 : 0, to = end ? n - 2 : 1;
        double d[3], size = 0.0;
        for (int c = 0; c < 3; c++) {
            d[c] = x[c * plane + to * stride] - line[c][from];
            size += d[c] * d[c];
        }
        for (int c = 0; c < 3 && wanted > 0.0; c++)
            x[c * plane + to * stride] = line[c][from] + wanted / sqrt(size) * d[c];
    }
}

static void lines_share(void *data, Member member)
{
    const Lines *l = data;
    const ptrdiff_t plane = l->before * l->n * l->after;
    double *room = team_room(member);
    const Range mine = team_share(l->before, member);
    for (ptrdiff_t b = mine.first; b < mine.last; b++)
        for (ptrdiff_t a = 0; a < l->after; a++) {
            const ptrdiff_t at = b * l->after + a;
            respace(l, l->nodes + b * l->n * l->after + a, plane, l->low ? l->low[at] : 0.0,
                    l->high ? l->high[at] : 0.0, room);
        }
}

int volume_lines(double *nodes, ptrdiff_t before, ptrdiff_t n, ptrdiff_t after, const double *low, const double *high,
                  double reach, int threads)
{
    Lines l = {nodes, before, n, after, low, high, reach};
    return team_run_in_rooms(threads, ROWS * (size_t)n, lines_share, &l);
}
