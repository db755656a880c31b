#include "curve.h"

#include <math.h>

void curve_locate(const ArcLengths *curve, const double *s, ptrdiff_t m, ptrdiff_t *interval, double *place)
{
    const double *table = curve->table;
    const ptrdiff_t pieces = curve->pieces, last = curve->n * pieces - 1;
    const double length = table[last + 1];
    ptrdiff_t k = 0;
    for (ptrdiff_t i = 0; i < m; i++) {
        double at = s[i];
        if (curve->closed && !(0.0 <= at && at < length))
            at = at - length * floor(at / length);
        at = 0.0 > at ? 0.0 : at;
        at = length < at ? length : at;
        if (!(table[k] <= at && at < table[k + 1])) {
            if (k < last && table[k + 1] <= at && at < table[k + 2]) {
                k++;
            } else {
                ptrdiff_t low = 0, high = last + 1;
                while (high - low > 1) {
                    k = (low + high) / 2;
                    if (table[k] <= at)
                        low = k;
                    else
                        high = k;
                }
                k = low;
            }
        }
        interval[i] = k / pieces;
        if (at >= length) {
            place[i] = 1.0;
            continue;
        }
        const double f = (at - table[k]) / (table[k + 1] - table[k]), a = curve->start[k], b = curve->stop[k];
        place[i] = ((double)(k % pieces) + f * (a + f * ((3.0 - 2.0 * a - b) + f * (a + b - 2.0)))) / (double)pieces;
    }
}

void curve_points(const double *cubic, ptrdiff_t n, const ptrdiff_t *interval, const double *place, ptrdiff_t m,
                  const double *end, double *points)
{
    for (ptrdiff_t i = 0; i < m; i++)
        for (int j = 0; j < 2; j++) {
            const double *c = cubic + 2 * interval[i] + j, t = place[i];
            points[2 * i + j] = t == 1.0 ? end[j] : c[0] + t * (c[2 * n] + t * (c[4 * n] + t * c[6 * n]));
        }
}

void curve_slopes(const double *cubic, ptrdiff_t n, const ptrdiff_t *interval, const double *place, ptrdiff_t m,
                  double *derivatives)
{
    for (ptrdiff_t i = 0; i < m; i++)
        for (int j = 0; j < 2; j++) {
            const double *c = cubic + 2 * interval[i] + j, t = place[i];
            derivatives[2 * i + j] = c[2 * n] + t * (2.0 * c[4 * n] + 3.0 * t * c[6 * n]);
        }
}

void curve_speeds(const double *cubic, ptrdiff_t n, const double *places, ptrdiff_t m, double *lengths)
{
    for (ptrdiff_t k = 0; k < n; k++)
        for (ptrdiff_t i = 0; i < m; i++) {
            const double *c = cubic + 2 * k, t = places[i];
            const double x = c[2 * n] + t * (2.0 * c[4 * n] + 3.0 * t * c[6 * n]);
            const double y = c[2 * n + 1] + t * (2.0 * c[4 * n + 1] + 3.0 * t * c[6 * n + 1]);
            lengths[k * m + i] = sqrt(x * x + y * y);
        }
}

void cubic_values(const double *knots, const double *values, const double *bends, ptrdiff_t n, ptrdiff_t width,
                  const double *places, ptrdiff_t m, double *out)
{
    for (ptrdiff_t i = 0; i < m; i++) {
        ptrdiff_t low = 0, high = n - 1;
        while (high - low > 1) {
            const ptrdiff_t k = (low + high) / 2;
            if (knots[k] <= places[i])
                low = k;
            else
                high = k;
        }
        const double *start = values + low * width, *begin = bends + low * width;
        const double h = knots[low + 1] - knots[low], t = (places[i] - knots[low]) / h;
        const double part = t * (1.0 - t) * (h * h) / 6.0;
        for (ptrdiff_t j = 0; j < width; j++) {
            const double bend = (2.0 - t) * begin[j] + (1.0 + t) * begin[j + width], stop = start[j + width];
            out[i * width + j] = t == 1.0 ? stop : start[j] + t * (stop - start[j]) - part * bend;
        }
    }
}

void tridiagonal_solve(const double *lower, const double *diagonal, const double *upper, double *right, ptrdiff_t n,
                       ptrdiff_t k, double *ratio)
{
    double pivot = n > 0 ? diagonal[0] : 1.0;
    for (ptrdiff_t j = 0; j < (n > 0 ? k : 0); j++)
        right[j] = right[j] / pivot;
    for (ptrdiff_t i = 1; i < n; i++) {
        double *row = right + i * k;
        ratio[i - 1] = upper[i - 1] / pivot;
        pivot = diagonal[i] - lower[i] * ratio[i - 1];
        for (ptrdiff_t j = 0; j < k; j++)
            row[j] = (row[j] - lower[i] * row[j - k]) / pivot;
    }
    for (ptrdiff_t i = n - 2; i >= 0; i--)
        for (ptrdiff_t j = 0; j < k; j++)
            right[i * k + j] -= ratio[i] * right[(i + 1) * k + j];
}
