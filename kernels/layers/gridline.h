/* A grid line as a curve: cubic Hermite pieces between its nodes, tangents those of parabolas through three nodes. */
#ifndef MESHONET_GRIDLINE_H
#define MESHONET_GRIDLINE_H
#include "clones.h"
#include <math.h>
#include <stddef.h>

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

#endif
