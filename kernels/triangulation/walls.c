/* Points are looked up in square buckets as wide as the farthest that matters, up to some width. */
#include "walls.h"
#include <math.h>
#include <stdlib.h>

#define BEYOND 1.000000001 /* times a limit: what is on it but for rounding is not beyond it */

typedef struct {
    double left, bottom, width;
    ptrdiff_t across, up;
    ptrdiff_t *first, *point; /* those of bucket b: point[first[b]] to point[first[b + 1] - 1] */
} Buckets;

static ptrdiff_t within(double k, ptrdiff_t count) { return k <= 0 ? 0 : k >= (double)count ? count - 1 : (ptrdiff_t)k; }
static ptrdiff_t column(const Buckets *b, double x) { return within((x - b->left) / b->width, b->across); }
static ptrdiff_t row(const Buckets *b, double y) { return within((y - b->bottom) / b->width, b->up); }

static int fill(Buckets *b, const double *p, ptrdiff_t n)
{
    double left = p[0], right = p[0], bottom = p[1], top = p[1];
    for (ptrdiff_t k = 1; k < n; k++) {
        left = p[2 * k] < left ? p[2 * k] : left, right = p[2 * k] > right ? p[2 * k] : right;
        bottom = p[2 * k + 1] < bottom ? p[2 * k + 1] : bottom, top = p[2 * k + 1] > top ? p[2 * k + 1] : top;
    }
    const double wide = right - left, high = top - bottom, larger = wide > high ? wide : high;
    b->width = larger > 0 ? larger / (1.0 + sqrt((double)n)) : 1.0;
    b->left = left, b->bottom = bottom;
    b->across = 1 + (ptrdiff_t)(wide / b->width), b->up = 1 + (ptrdiff_t)(high / b->width);
    b->first = calloc((size_t)(b->across * b->up + 2), sizeof(ptrdiff_t));
    b->point = malloc((size_t)n * sizeof(ptrdiff_t));
    if (!b->first || !b->point)
        return -1;
    for (ptrdiff_t k = 0; k < n; k++)
        b->first[row(b, p[2 * k + 1]) * b->across + column(b, p[2 * k]) + 2]++;
    for (ptrdiff_t k = 2; k < b->across * b->up + 2; k++)
        b->first[k] += b->first[k - 1];
    for (ptrdiff_t k = 0; k < n; k++)
        b->point[b->first[row(b, p[2 * k + 1]) * b->across + column(b, p[2 * k]) + 1]++] = k;
    return 0;
}

/* Whether point `other`, at a distance from point k, is only the wall behind a corner. */
static int round_corner(const WallPoints *wall, ptrdiff_t k, ptrdiff_t other, double distance)
{
    for (int i = 0; i < 2; i++)
        if (wall->piece[other] == wall->beside[2 * k + i] && distance > BEYOND * wall->corner[2 * k + i])
            return 1;
    return 0;
}

int wall_gaps(const WallPoints *wall, double part, double cone, double *size)
{
    const double *points = wall->points, *normals = wall->normals;
    const ptrdiff_t n = wall->n;
    Buckets b = {0};
    if (n == 0)
        return 0;
    int status = fill(&b, points, n);
    for (ptrdiff_t k = 0; k < n && !status; k++) {
        const double x = points[2 * k], y = points[2 * k + 1], nx = normals[2 * k], ny = normals[2 * k + 1];
        double reach = size[k] / part;
        for (ptrdiff_t r = row(&b, y - reach); r <= row(&b, y + reach); r++)
            for (ptrdiff_t i = b.first[r * b.across + column(&b, x - reach)];
                 i < b.first[r * b.across + column(&b, x + reach) + 1]; i++) {
                const ptrdiff_t other = b.point[i];
                const double dx = points[2 * other] - x, dy = points[2 * other + 1] - y, d2 = dx * dx + dy * dy;
                const double ahead = dx * nx + dy * ny;
                if (d2 < reach * reach && ahead > 0 && ahead * ahead > BEYOND * cone * cone * d2 &&
                    !round_corner(wall, k, other, sqrt(d2)))
                    reach = sqrt(d2);
            }
        size[k] = part * reach < size[k] ? part * reach : size[k];
    }
    free(b.first), free(b.point);
    return status;
}

int wall_growth(const double *points, ptrdiff_t n, double growth, double *size)
{
    Buckets b = {0};
    if (n == 0)
        return 0;
    int status = fill(&b, points, n);
    double least = size[0];
    for (ptrdiff_t k = 1; k < n; k++)
        least = size[k] < least ? size[k] : least;
    for (ptrdiff_t k = 0; k < n && !status; k++) {
        const double x = points[2 * k], y = points[2 * k + 1], reach = (size[k] - least) / growth;
        for (ptrdiff_t r = row(&b, y - reach); r <= row(&b, y + reach); r++)
            for (ptrdiff_t i = b.first[r * b.across + column(&b, x - reach)];
                 i < b.first[r * b.across + column(&b, x + reach) + 1]; i++) {
                const ptrdiff_t other = b.point[i];
                const double dx = points[2 * other] - x, dy = points[2 * other + 1] - y;
                const double allowed = size[other] + growth * sqrt(dx * dx + dy * dy);
                size[k] = allowed < size[k] ? allowed : size[k];
            }
    }
    free(b.first), free(b.point);
    return status;
}
