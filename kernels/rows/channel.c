#include "channel.h"
#include "clones.h"
#include "elementary/functions.h"
#include "lanes.h"

#include <string.h>

#define BATCH 64

/* The part of the way from hub to casing at a height, from those at the levels. */
MESHONET_INLINE double part_at(const Channel *channel, const double *parts, double h)
{
    const ptrdiff_t last = channel->count - 1;
    ptrdiff_t k = 0;
    while (k + 1 < last && h >= channel->levels[k + 1])
        k++;
    const double share = (h - channel->levels[k]) / (channel->levels[k + 1] - channel->levels[k]);
    const double low = k > 0 ? parts[k] : 0.0, high = k + 1 < last ? parts[k + 1] : 1.0;
    return share == 1.0 ? high : low + share * (high - low);
}

MESHONET_INLINE void point_at(const Channel *channel, double s, double h, double *x, double *r)
{
    const double place = s * (double)channel->pieces, last = (double)(channel->pieces - 1);
    const ptrdiff_t piece = place > 0.0 ? (ptrdiff_t)(place < last ? place : last) : 0;
    const double *cubic = channel->cubics + piece * 4 * CHANNEL_COLUMNS, t = place - (double)piece;
    double value[CHANNEL_COLUMNS];
    AT(value) = ((OF(cubic + 3 * CHANNEL_COLUMNS) * t + OF(cubic + 2 * CHANNEL_COLUMNS)) * t + OF(cubic + CHANNEL_COLUMNS)) * t + OF(cubic);
    const double part = part_at(channel, value + 4, h);
    *x = value[0] + part * value[2], *r = value[1] + part * value[3];
}

MESHONET_CLONES
void channel_points(const Channel *channel, const double *s, const double *h, ptrdiff_t n, double *points)
{
    for (ptrdiff_t k = 0; k < n; k++)
        point_at(channel, s[k], h[k], points + 2 * k, points + 2 * k + 1);
}

MESHONET_CLONES
void channel_space(const Channel *channel, const double *values, ptrdiff_t n, double *space)
{
    const Function sines = function_named("sin"), cosines = function_named("cos");
    double radius[BATCH], theta[BATCH], sine[BATCH], cosine[BATCH];
    for (ptrdiff_t first = 0; first < n; first += BATCH) {
        const ptrdiff_t count = n - first < BATCH ? n - first : BATCH;
        const double *from = values + 3 * first;
        double *to = space + 3 * first;
        for (ptrdiff_t k = 0; k < count; k++) {
            point_at(channel, from[3 * k], from[3 * k + 2], to + 3 * k, radius + k);
            theta[k] = from[3 * k + 1];
        }
        sines(theta, count, sine);
        cosines(theta, count, cosine);
        for (ptrdiff_t k = 0; k < count; k++)
            to[3 * k + 1] = radius[k] * sine[k], to[3 * k + 2] = radius[k] * cosine[k];
    }
}

void channel_nodes(const Channel *channel, const double *values, const ptrdiff_t *ids, ptrdiff_t levels, ptrdiff_t n,
                   ptrdiff_t nodes, double *space)
{
    double own[3 * BATCH];
    for (ptrdiff_t level = 0; level < levels; level++)
        for (ptrdiff_t first = 0; first < n; first += BATCH) {
            const ptrdiff_t count = n - first < BATCH ? n - first : BATCH;
            channel_space(channel, values + 3 * (level * n + first), count, own);
            for (ptrdiff_t k = 0; k < count; k++)
                memcpy(space + 3 * (level * nodes + ids[first + k]), own + 3 * k, 3 * sizeof *own);
        }
}
