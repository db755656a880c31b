/* Nodes moved along grid lines so that the first cell of each has a given height.

   The arc lengths A_j of a line become T_j = A_j (1 + (c - 1) fade_j), where c is found such that nodes 0 and 1
   end up `first[i]` apart. */
#include "redistribute.h"
#include "gridline.h"

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
