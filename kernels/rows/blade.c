#include "blade.h"
#include "clones.h"
#include "elementary.h"
#include <math.h>

#define NEWTON 8        /* steps */
#define CONVERGED 1e-14 /* of the span: steps that are rounding */
#define ROUNDS 5        /* in which a cell that is nearly as high as it has to be becomes exactly so */
#define BATCH 64        /* columns */

/* Value and slope of spline k at a place, h first. */
static void spline_at(const Splines *s, ptrdiff_t k, double place, double *value, double *slope)
{
    const double low = s->knots[0], high = s->knots[s->count - 1];
    const double inside = place < low ? low : place > high ? high : place, out = place - inside;
    ptrdiff_t piece = 0;
    while (piece + 2 < s->count && inside >= s->knots[piece + 1])
        piece++;
    const ptrdiff_t at = 3 * (piece * s->n + k), after = at + 3 * s->n;
    const double h = s->knots[piece + 1] - s->knots[piece], t = (inside - s->knots[piece]) / h, left = 1.0 - t;
    for (int c = 0; c < 3; c++) {
        const double start = s->values[at + c], stop = s->values[after + c];
        const double begin = s->bends[at + c], end = s->bends[after + c];
        const double bend = (2.0 - t) * begin + (1.0 + t) * end;
        const double inner = start + t * (stop - start) - t * left * (h * h) / 6.0 * bend;
        slope[c] = (stop - start) / h + h / 6.0 * ((3.0 * t * t - 1.0) * end - (3.0 * left * left - 1.0) * begin);
        value[c] = (t == 1.0 ? stop : inner) + out * slope[c];
    }
}

void spline_crossings(const Splines *splines, const double *heights, ptrdiff_t levels, double *points)
{
    const ptrdiff_t n = levels * splines->n;
    double value[3], slope[3], most = INFINITY;
    for (ptrdiff_t k = 0; k < n; k++)
        points[2 * k] = heights[k]; /* the place on the spline, until it is known */
    for (int round = 0; round < NEWTON && most >= CONVERGED; round++) {
        most = 0.0;
        for (ptrdiff_t k = 0; k < n; k++) {
            spline_at(splines, k % splines->n, points[2 * k], value, slope);
            const double step = (value[2] - heights[k]) / slope[2];
            points[2 * k] -= step;
            most = larger(magnitude(step), most);
        }
    }
    for (ptrdiff_t k = 0; k < n; k++) {
        spline_at(splines, k % splines->n, points[2 * k], value, slope);
        points[2 * k] = value[0], points[2 * k + 1] = value[1];
    }
}

/* The same, with the factors (n,) by which the cells became longer. */
static void lengthen(const Channel *channel, const double *begin, const double *sizes, ptrdiff_t n, double *end,
                     double *factor)
{
    double start[3 * BATCH], stop[3 * BATCH];
    channel_space(channel, begin, n, start);
    for (ptrdiff_t k = 0; k < n; k++)
        factor[k] = 1.0;
    for (int round = 0; round < ROUNDS; round++) {
        channel_space(channel, end, n, stop);
        for (ptrdiff_t k = 0; k < n; k++) {
            const double x = stop[3 * k] - start[3 * k], y = stop[3 * k + 1] - start[3 * k + 1];
            const double z = stop[3 * k + 2] - start[3 * k + 2], more = sizes[k] / sqrt(x * x + y * y + z * z);
            factor[k] *= more;
            for (int c = 0; c < 3; c++)
                end[3 * k + c] = begin[3 * k + c] + (end[3 * k + c] - begin[3 * k + c]) * more;
        }
    }
}

void lengthen_cells(const Channel *channel, const double *begin, const double *sizes, ptrdiff_t n, double *end)
{
    double factor[BATCH];
    for (ptrdiff_t first = 0; first < n; first += BATCH)
        lengthen(channel, begin + 3 * first, sizes + first, n - first < BATCH ? n - first : BATCH, end + 3 * first,
                 factor);
}

void columns_on_blade(const Channel *channel, const double *wall, double first, ptrdiff_t n, ptrdiff_t rows,
                      double *columns)
{
    const double last = (double)(rows - 1), beyond = (double)(rows - 2);
    double begin[3 * BATCH], end[3 * BATCH], sizes[BATCH], factor[BATCH];
    for (ptrdiff_t start = 0; start < n; start += BATCH) {
        const ptrdiff_t count = n - start < BATCH ? n - start : BATCH;
        for (ptrdiff_t k = 0; k < count; k++) {
            double *column = columns + 3 * (start + k) * rows;
            const double s = wall[2 * (start + k)] - column[0], theta = wall[2 * (start + k) + 1] - column[1];
            for (ptrdiff_t row = 0; row < rows; row++) {
                const double way = (double)row / last, share = (1.0 - way * way) * (1.0 - way * way);
                column[3 * row] += share * s, column[3 * row + 1] += share * theta;
            }
            for (int c = 0; c < 3; c++)
                begin[3 * k + c] = column[c], end[3 * k + c] = column[3 + c];
            sizes[k] = first;
        }
        lengthen(channel, begin, sizes, count, end, factor);
        for (ptrdiff_t k = 0; k < count; k++) {
            double *column = columns + 3 * (start + k) * rows;
            for (int c = 0; c < 3; c++)
                column[3 + c] = end[3 * k + c];
            for (ptrdiff_t row = 2; row < rows - 1; row++) {
                const double left = 1.0 - (double)(row - 1) / beyond, scale = 1.0 + left * left * (factor[k] - 1.0);
                for (int c = 0; c < 3; c++)
                    column[3 * row + c] = begin[3 * k + c] + (column[3 * row + c] - begin[3 * k + c]) * scale;
            }
        }
    }
}
