/* Nodes moved along grid lines so that the first cell of each has a given height.

   The arc lengths A_j of a line become T_j = A_j (1 + (c - 1) fade_j), where c is found such that nodes 0 and 1
   end up `first[i]` apart. Between its nodes a line is the cubic Hermite curve whose tangents are those of parabolas
   through three nodes. */
#include "redistribute_kernel.h"
#include "clones.h"
#include <math.h>

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

MESHONET_CLONES
void redistribute_lines(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const double *first, const double *fade,
                        double *scratch)
{
    const Line line = {scratch, scratch + nj, scratch + 2 * nj, scratch + 3 * nj, scratch + 4 * nj};
    for (ptrdiff_t i = 0; i < ni; i++, x += nj, y += nj) {
        measure_line(&line, x, y, nj);
        const double more = place_of_first(&line, first[i], nj) / line.arc[1] - 1.0;
        ptrdiff_t k = 0;
        for (ptrdiff_t j = 1; j < nj - 1; j++) {
            const double t = line.arc[j] * (1.0 + more * fade[j]);
            double dx, dy;
            k = piece(&line, k, t, nj);
            displacement(&line, k, t, &dx, &dy);
            x[j] = line.px[k] + dx, y[j] = line.py[k] + dy;
        }
    }
}
