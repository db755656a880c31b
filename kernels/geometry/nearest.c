#include "nearest.h"
#include "clones.h"
#include <math.h>

enum { BLOCK = 64 };

MESHONET_INLINE double least_square(double px, double py, const double *restrict x, const double *restrict y,
                                    ptrdiff_t n)
{
    double least = INFINITY;
    MESHONET_INDEPENDENT
    for (ptrdiff_t k = 0; k < n; k++) {
        const double dx = x[k] - px, dy = y[k] - py, square = dx * dx + dy * dy;
        least = square < least ? square : least;
    }
    return least;
}

MESHONET_CLONES
void nearest_points(const double *places, ptrdiff_t m, const double *x, const double *y, ptrdiff_t n, ptrdiff_t *index,
                    double *square)
{
    for (ptrdiff_t i = 0; i < m; i++) {
        const double px = places[2 * i], py = places[2 * i + 1];
        double best = INFINITY;
        ptrdiff_t block = 0;
        for (ptrdiff_t k = 0; k < n; k += BLOCK) {
            const double least = least_square(px, py, x + k, y + k, n - k < BLOCK ? n - k : BLOCK);
            if (least < best)
                best = least, block = k;
        }
        /* the same sums again may differ in the last bit, so the least of these is taken */
        const ptrdiff_t stop = n - block < BLOCK ? n : block + BLOCK;
        double nearest = INFINITY;
        for (ptrdiff_t k = block; k < stop; k++) {
            const double dx = x[k] - px, dy = y[k] - py, s = dx * dx + dy * dy;
            if (s < nearest)
                nearest = s, index[i] = k;
        }
        square[i] = nearest;
    }
}
