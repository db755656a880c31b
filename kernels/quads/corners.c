#include "corners.h"

void smallest_corners(const double *nodes, const ptrdiff_t *quads, ptrdiff_t m, double *smallest)
{
    for (ptrdiff_t q = 0; q < m; q++, quads += 4) {
        double x[4], y[4], low = 0.0, sum = 0.0;
        for (int k = 0; k < 4; k++) {
            const double *from = nodes + 2 * quads[k], *to = nodes + 2 * quads[(k + 1) % 4];
            x[k] = to[0] - from[0], y[k] = to[1] - from[1];
        }
        for (int k = 0; k < 4; k++) {
            const int next = (k + 1) % 4;
            const double jacobian = x[k] * y[next] - y[k] * x[next];
            low = k && low < jacobian ? low : jacobian;
            sum += jacobian;
        }
        smallest[q] = low + 0.0 * sum;
    }
}
