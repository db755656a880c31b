/* Transfinite interpolation of four edges: the Boolean sum x of the interpolations between opposite edges, at the
   point (u, v) where lines between equal parameters s and n, w and e of opposite edges cross:
       u = (s + (n - s) w) / (1 - (n - s)(e - w)),    v = w + (e - w) u,
       x = (1-v) S_i + v N_i  +  (1-u) W_j + u E_j  -  (1-u)(1-v) a - u (1-v) b - u v c - (1-u) v d. */
#include "tfi.h"

#include <string.h>

#include "clones.h"
#include "team.h"

/* Boolean sum in one coordinate; dw and de are the deviations of west and east from their chords. */
MESHONET_INLINE double boolean_sum(double u, double v, double s, double n, double w, double e, double a, double b,
                                   double c, double d)
{
    const double west = w - a - v * (d - a);
    const double east = e - b - v * (c - b);
    return s + v * (n - s) + west + u * (east - west);
}

MESHONET_INLINE void fill_row(double *restrict x, double *restrict y, ptrdiff_t i, ptrdiff_t ni, ptrdiff_t nj,
                     const TfiEdges *ex, const TfiEdges *ey, const TfiEdges *parameter)
{
    const double s = parameter->south[i], ds = parameter->north[i] - s;
    const double *restrict w = parameter->west, *restrict e = parameter->east;
    const double xs = ex->south[i], xn = ex->north[i], ys = ey->south[i], yn = ey->north[i];
    const double *restrict xw = ex->west, *restrict xe = ex->east, *restrict yw = ey->west, *restrict ye = ey->east;
    const double xa = ex->south[0], xb = ex->south[ni - 1], xc = ex->north[ni - 1], xd = ex->north[0];
    const double ya = ey->south[0], yb = ey->south[ni - 1], yc = ey->north[ni - 1], yd = ey->north[0];
    for (ptrdiff_t j = 1; j < nj - 1; j++) {
        const double de = e[j] - w[j];
        const double u = (s + ds * w[j]) / (1.0 - ds * de);
        const double v = w[j] + de * u;
        x[j] = boolean_sum(u, v, xs, xn, xw[j], xe[j], xa, xb, xc, xd);
        y[j] = boolean_sum(u, v, ys, yn, yw[j], ye[j], ya, yb, yc, yd);
    }
    x[0] = xs, y[0] = ys, x[nj - 1] = xn, y[nj - 1] = yn;
}

typedef struct {
    double *x, *y;
    ptrdiff_t ni, nj;
    const TfiEdges *ex, *ey, *parameter;
} Fill;

MESHONET_CLONES
static void fill_rows(const Fill *f, ptrdiff_t first, ptrdiff_t last)
{
    for (ptrdiff_t i = first + 1; i <= last; i++)
        fill_row(f->x + i * f->nj, f->y + i * f->nj, i, f->ni, f->nj, f->ex, f->ey, f->parameter);
}

TEAM_ROWS(fill_share, Fill, task->ni - 2, fill_rows)

void tfi_fill(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const TfiEdges *ex, const TfiEdges *ey,
              const TfiEdges *parameter, int threads)
{
    Fill fill = {x, y, ni, nj, ex, ey, parameter};
    const size_t line = (size_t)nj * sizeof *x;
    const ptrdiff_t last = (ni - 1) * nj;
    memcpy(x, ex->west, line), memcpy(y, ey->west, line);
    team_run(threads, fill_share, &fill);
    memcpy(x + last, ex->east, line), memcpy(y + last, ey->east, line);
}
