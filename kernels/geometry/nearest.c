#include "nearest.h"
#include "clones.h"
#include <math.h>

/* compiled without contraction, so that a sum of squares is the same number in each of these loops */
enum { LANES = 8 };

MESHONET_INLINE double square_to(double px, double py, double x, double y)
{
    const double dx = x - px, dy = y - py;
    return dx * dx + dy * dy;
}

MESHONET_INLINE double least_square(double px, double py, const double *restrict x, const double *restrict y,
                                    ptrdiff_t n)
{
    double lane[LANES], least = INFINITY;
    ptrdiff_t k = 0;
    for (int l = 0; l < LANES; l++)
        lane[l] = INFINITY;
    for (; k + LANES <= n; k += LANES)
        for (int l = 0; l < LANES; l++) {
            const double square = square_to(px, py, x[k + l], y[k + l]);
            lane[l] = square < lane[l] ? square : lane[l];
        }
    for (int l = 0; l < LANES; l++)
        least = lane[l] < least ? lane[l] : least;
    for (; k < n; k++) {
        const double square = square_to(px, py, x[k], y[k]);
        least = square < least ? square : least;
    }
    return least;
}

/* the square of the distance to a box, rounded as that to a point in it, so that it is never more than that */
MESHONET_INLINE double square_to_box(double px, double py, const double *low, const double *high)
{
    const double left = low[0] - px, right = px - high[0], below = low[1] - py, above = py - high[1];
    const double dx = left > 0.0 ? left : right > 0.0 ? right : 0.0;
    const double dy = below > 0.0 ? below : above > 0.0 ? above : 0.0;
    return dx * dx + dy * dy;
}

MESHONET_CLONES
void nearest_points(const double *places, ptrdiff_t m, const double *x, const double *y, ptrdiff_t n, const double *low,
                    const double *high, ptrdiff_t *index, double *square)
{
    const ptrdiff_t blocks = (n + nearest_block - 1) / nearest_block;
    ptrdiff_t nearest = 0;
    for (ptrdiff_t i = 0; i < m; i++) {
        const double px = places[2 * i], py = places[2 * i + 1];
        double best = INFINITY;
        /* first the block of the place before, as the next place is often beside it */
        for (ptrdiff_t turn = -1, before = nearest; turn < blocks; turn++) {
            const ptrdiff_t b = turn < 0 ? before : turn, at = b * nearest_block;
            if (turn == before || (turn >= 0 && square_to_box(px, py, low + 2 * b, high + 2 * b) > best))
                continue;
            const double least = least_square(px, py, x + at, y + at, n - at < nearest_block ? n - at : nearest_block);
            if (least < best || (least == best && b < nearest))
                best = least, nearest = b;
        }
        ptrdiff_t k = nearest * nearest_block;
        const ptrdiff_t last = n - k < nearest_block ? n - 1 : k + nearest_block - 1;
        while (k < last && square_to(px, py, x[k], y[k]) > best)
            k++;
        index[i] = k;
        square[i] = best;
    }
}
