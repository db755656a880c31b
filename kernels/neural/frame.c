/* The arithmetic of frame.py on one grid at a time. */
#include "frame.h"

#include <math.h>

#include "clones.h"

/* Sums over the outline of a grid: its nodes, and twice its area; sums of east less west
   and of north less south. */
typedef struct {
    double x, y, area, along[2], across[2];
} Outline;

MESHONET_INLINE void take(Outline *o, const double *x, const double *y, ptrdiff_t at, ptrdiff_t next)
{
    o->x += x[at], o->y += y[at];
    o->area += (x[at] - x[0]) * (y[next] - y[0]) - (y[at] - y[0]) * (x[next] - x[0]);
}

MESHONET_INLINE Outline outline(const double *x, const double *y, ptrdiff_t m, ptrdiff_t n)
{
    const ptrdiff_t east = (m - 1) * n, north = n - 1;
    Outline o = {0};
    for (ptrdiff_t i = 0; i < m - 1; i++) {
        take(&o, x, y, i * n, (i + 1) * n);
        take(&o, x, y, (i + 1) * n + north, i * n + north);
    }
    for (ptrdiff_t j = 0; j < n - 1; j++) {
        take(&o, x, y, east + j, east + j + 1);
        take(&o, x, y, j + 1, j);
    }
    for (ptrdiff_t j = 0; j < n; j++)
        o.along[0] += x[east + j] - x[j], o.along[1] += y[east + j] - y[j];
    for (ptrdiff_t i = 0; i < m; i++)
        o.across[0] += x[i * n + north] - x[i * n], o.across[1] += y[i * n + north] - y[i * n];
    return o;
}

MESHONET_CLONES
void frame_take_out(const double *planes, ptrdiff_t m, ptrdiff_t n, double *factor, double *out)
{
    const ptrdiff_t size = m * n;
    const double *restrict x = planes, *restrict y = planes + size;
    double *restrict to_x = out, *restrict to_y = out + size;
    const Outline o = outline(x, y, m, n);
    const double nodes = (double)(2 * (m + n - 2)), middle_x = o.x / nodes, middle_y = o.y / nodes;
    const double re = o.along[0] / (double)n + o.across[1] / (double)m; /* east - west - i (north - south) */
    const double im = o.along[1] / (double)n - o.across[0] / (double)m;
    const double scale = 1.0 / (sqrt(re * re + im * im) * sqrt(0.5 * o.area)), a = re * scale, b = -im * scale;
    for (ptrdiff_t k = 0; k < size; k++) {
        const double dx = x[k] - middle_x, dy = y[k] - middle_y;
        to_x[k] = dx * a - dy * b;
        to_y[k] = dx * b + dy * a;
    }
    factor[0] = a, factor[1] = b;
}

MESHONET_CLONES
void frame_put_back(double *planes, const double *moved, const double *unit, ptrdiff_t m, ptrdiff_t n,
                    const double *factor)
{
    const ptrdiff_t size = m * n;
    const double square = factor[0] * factor[0] + factor[1] * factor[1];
    const double a = factor[0] / square, b = -factor[1] / square;
    double *restrict x = planes, *restrict y = planes + size;
    const double *restrict to_x = moved, *restrict to_y = moved + size;
    const double *restrict from_x = unit, *restrict from_y = unit + size;
    for (ptrdiff_t k = 0; k < size; k++) {
        const double dx = to_x[k] - from_x[k], dy = to_y[k] - from_y[k];
        x[k] += dx * a - dy * b;
        y[k] += dx * b + dy * a;
    }
}

#define ADD(T) \
    MESHONET_CLONES \
    void frame_add_##T(double *planes, const T *answers, ptrdiff_t numbers, const double *rim, ptrdiff_t m, ptrdiff_t n) \
    { \
        const ptrdiff_t size = m * n; \
        double *restrict x = planes, *restrict y = planes + size; \
        for (ptrdiff_t k = 0; k < size; k++) { \
            x[k] += rim[k] * (double)answers[k * numbers]; \
            y[k] += rim[k] * (double)answers[k * numbers + 1]; \
        } \
    }

ADD(float)
ADD(double)
