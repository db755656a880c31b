#include "segments.h"

typedef struct {
    double x, y;
} Point;

/* The side of the line from a to b on which p lies: 1 left, -1 right, 0 on it. */
static int side(Point a, Point b, Point p)
{
    const double left = (b.x - a.x) * (p.y - a.y), right = (b.y - a.y) * (p.x - a.x);
    return (left > right) - (left < right);
}

static int between(double a, double b, double value)
{
    return (a < b ? a : b) <= value && value <= (a < b ? b : a);
}

static int within(Point a, Point b, Point p)
{
    return between(a.x, b.x, p.x) && between(a.y, b.y, p.y);
}

/* Whether the segments a b and c d have a point in common. */
static int meet(Point a, Point b, Point c, Point d)
{
    const int s1 = side(a, b, c), s2 = side(a, b, d), s3 = side(c, d, a), s4 = side(c, d, b);
    if (s1 * s2 < 0 && s3 * s4 < 0)
        return 1;
    return (s1 == 0 && within(a, b, c)) || (s2 == 0 && within(a, b, d)) || (s3 == 0 && within(c, d, a)) ||
           (s4 == 0 && within(c, d, b));
}

/* Whether segment b c lies on segment a b, reversed. */
static int turns_back(Point a, Point b, Point c)
{
    const double ax = b.x - a.x, ay = b.y - a.y, bx = c.x - b.x, by = c.y - b.y;
    return ax * by == ay * bx && ax * bx + ay * by < 0;
}

/* Whether the boxes of two segments are apart. */
static int apart(Point a, Point b, Point c, Point d)
{
    const double left = a.x < b.x ? a.x : b.x, right = a.x < b.x ? b.x : a.x;
    const double bottom = a.y < b.y ? a.y : b.y, high = a.y < b.y ? b.y : a.y;
    return (c.y > high && d.y > high) || (c.y < bottom && d.y < bottom) || (c.x > right && d.x > right) ||
           (c.x < left && d.x < left);
}

ptrdiff_t crossing_segments(const double *points, ptrdiff_t n, const ptrdiff_t *order, ptrdiff_t m, const double *low,
                            const double *top, ptrdiff_t limit, long long *budget, ptrdiff_t *pairs)
{
    const Point *p = (const Point *)points;
    ptrdiff_t found = 0;
    for (ptrdiff_t a = 0; a < m; a++) {
        const ptrdiff_t i = order[a], ii = (i + 1) % n;
        for (ptrdiff_t b = a + 1; b < m && low[order[b]] <= top[i]; b++) {
            const ptrdiff_t j = order[b], jj = (j + 1) % n;
            --*budget;
            if (apart(p[i], p[ii], p[j], p[jj]))
                continue;
            const int meets = ii == j   ? turns_back(p[i], p[ii], p[jj])
                              : jj == i ? turns_back(p[j], p[jj], p[ii])
                                        : meet(p[i], p[ii], p[j], p[jj]);
            if (!meets)
                continue;
            pairs[2 * found] = i < j ? i : j, pairs[2 * found + 1] = i < j ? j : i;
            if (++found >= limit) {
                *budget = 0; /* what there is suffices */
                return found;
            }
        }
        if (*budget < 0)
            break;
    }
    return found;
}
