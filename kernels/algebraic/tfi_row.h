/* One row of transfinite interpolation; the formula stands in tfi.c. */
#ifndef MESHONET_TFI_ROW_H
#define MESHONET_TFI_ROW_H
#include "clones.h"
#include "tfi.h"

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
#endif
