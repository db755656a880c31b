#include "ahead.h"
#include "clones.h"

#include <math.h>

#define BATCH 64
#define NEARLY (1.0 + 1e-12) /* squares are rounded: what they leave in doubt is decided by the distance */

/* The squares of distances to a batch of walls ahead, nearly all of them; infinite for others. */
MESHONET_INLINE double squares_ahead(const double *walls, ptrdiff_t count, const double *point, const double *along,
                                     double cosine, double *square)
{
    double least = INFINITY;
    for (ptrdiff_t k = 0; k < count; k++) {
        const double dx = walls[2 * k] - point[0], dy = walls[2 * k + 1] - point[1];
        const double height = dy * along[0] - dx * along[1], own = dx * dx + dy * dy;
        square[k] = (height > 0.0) & (height * height * NEARLY >= cosine * cosine * own) ? own : INFINITY;
    }
    for (ptrdiff_t k = 0; k < count; k++)
        least = square[k] < least ? square[k] : least;
    return least;
}

MESHONET_CLONES
void nearest_ahead(const double *walls, ptrdiff_t n, const double *points, const double *along, ptrdiff_t m, double cosine,
                   double same, double *distances)
{
    double square[BATCH];
    for (ptrdiff_t i = 0; i < m; i++) {
        const double *point = points + 2 * i, *way = along + 2 * i;
        double nearest = INFINITY, bound = INFINITY;
        for (ptrdiff_t first = 0; first < n; first += BATCH) {
            const ptrdiff_t count = n - first < BATCH ? n - first : BATCH;
            if (!(squares_ahead(walls + 2 * first, count, point, way, cosine, square) < bound))
                continue;
            for (ptrdiff_t k = 0; k < count; k++) {
                if (!(square[k] < bound))
                    continue;
                const double dx = walls[2 * (first + k)] - point[0], dy = walls[2 * (first + k) + 1] - point[1];
                const double distance = hypot(dx, dy), height = dy * way[0] - dx * way[1];
                if (height > cosine * distance && distance > same && distance < nearest)
                    nearest = distance, bound = distance * distance * NEARLY;
            }
        }
        distances[i] = nearest;
    }
}
