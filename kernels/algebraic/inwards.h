/* Corrects a grid whose edges differ from given ones; the correction decays inwards (formula in resample/quad.py). */
#pragma once
#include <math.h>
#include <stddef.h>

#include "clones.h"
#include "team.h"

MESHONET_INLINE double length(double dx, double dy)
{
    return sqrt(dx * dx + dy * dy);
}

/* The mean step at node k of an edge, n nodes `stride` apart. */
MESHONET_INLINE double mean_step(const double *x, const double *y, ptrdiff_t k, ptrdiff_t n, ptrdiff_t stride)
{
    const ptrdiff_t before = (k > 0 ? k - 1 : 0) * stride, after = (k + 1 < n ? k : n - 2) * stride;
    return 0.5 * (length(x[before + stride] - x[before], y[before + stride] - y[before]) +
                  length(x[after + stride] - x[after], y[after + stride] - y[after]));
}

/* One over the way inside, along a line of length `whole` with its first cell `one`. */
MESHONET_INLINE double inverse_way(double reach, double one, double whole)
{
    const double way = reach < whole ? reach : whole;
    return 1.0 / (way > one ? way : one);
}

MESHONET_INLINE double left_at(double off, double inverse)
{
    const double left = 1.0 - off * inverse;
    return left > 0.0 ? left : 0.0;
}

/* Four tables (m, n), of south, north, west and east, from the planes x (2, m, n); spare holds 2 n. */
MESHONET_INLINE void inwards(const double *x, ptrdiff_t m, ptrdiff_t n, double reach, double *spare, double *tables)
{
    const ptrdiff_t size = m * n, last = size - n;
    const double *y = x + size;
    double *restrict south = tables, *restrict north = south + size;
    double *restrict west = north + size, *restrict east = west + size;
    for (ptrdiff_t k = 0; k < size; k += n) {
        south[k] = 0.0;
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = k + 1; j < k + n; j++)
            south[j] = length(x[j] - x[j - 1], y[j] - y[j - 1]);
        for (ptrdiff_t j = k + 1; j < k + n; j++)
            south[j] += south[j - 1];
        const double whole = south[k + n - 1];
        const double low = inverse_way(reach * mean_step(x, y, k / n, m, n), south[k + 1], whole);
        const double high = inverse_way(reach * mean_step(x + n - 1, y + n - 1, k / n, m, n), whole - south[k + n - 2], whole);
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = k; j < k + n; j++) {
            north[j] = left_at(whole - south[j], high);
            south[j] = left_at(south[j], low);
        }
    }
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < n; j++)
        west[j] = 0.0;
    for (ptrdiff_t i = 1; i < m; i++) /* row by row, so that the rows above are there */
        MESHONET_INDEPENDENT
        for (ptrdiff_t k = i * n; k < (i + 1) * n; k++)
            west[k] = west[k - n] + length(x[k] - x[k - n], y[k] - y[k - n]);
    double *restrict low = spare, *restrict high = low + n;
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < n; j++) {
        const double whole = west[last + j];
        low[j] = inverse_way(reach * mean_step(x, y, j, n, 1), west[n + j], whole);
        high[j] = inverse_way(reach * mean_step(x + last, y + last, j, n, 1), whole - west[last - n + j], whole);
    }
    for (ptrdiff_t k = 0; k < last; k += n)
        MESHONET_INDEPENDENT
        for (ptrdiff_t j = 0; j < n; j++) {
            east[k + j] = left_at(west[last + j] - west[k + j], high[j]);
            west[k + j] = left_at(west[k + j], low[j]);
        }
    MESHONET_INDEPENDENT
    for (ptrdiff_t j = 0; j < n; j++) {
        east[last + j] = 1.0;
        west[last + j] = left_at(west[last + j], low[j]);
    }
}

/* The fine columns, of nj, at which something is felt of a row of a table (n); what is felt of south begins at the
   first column, of north it ends at the last. */
MESHONET_INLINE Range felt(const double *row, ptrdiff_t n, ptrdiff_t nj, int north)
{
    ptrdiff_t first = 0, last = n - 1;
    if (north)
        for (first = n; first > 0 && row[first - 1] > 0.0;)
            first--;
    else
        for (last = -1; last < n - 1 && row[last + 1] > 0.0;)
            last++;
    const double cells = (double)(nj - 1) / (double)(n - 1);
    const ptrdiff_t from = (ptrdiff_t)floor((double)(first - 1) * cells), to = (ptrdiff_t)ceil((double)(last + 1) * cells) + 1;
    return (Range){from > 0 ? from : 0, to < nj ? to : nj};
}

MESHONET_INLINE Range joined(Range a, Range b)
{
    return (Range){a.first < b.first ? a.first : b.first, a.last > b.last ? a.last : b.last};
}
