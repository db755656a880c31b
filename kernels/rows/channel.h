/* The channel between hub and casing of a blade row: from (s, h) to places in it. */
#pragma once
#include <stddef.h>

#define CHANNEL_COLUMNS 8 /* of its tables */
#define CHANNEL_LEVELS 4  /* hub, foot and tip of the blade, casing */

/* `cubics` (pieces, 4, CHANNEL_COLUMNS) are, by rising powers of the place in each of the pieces into which s is divided: x, r
   of the hub, the way from there to the casing (2,), and the parts of that way at each of `levels` (count,). The first
   of these is 0, the hub, the last is 1. */
typedef struct {
    const double *cubics, *levels;
    ptrdiff_t pieces, count;
} Channel;

/* x, r (n, 2) at s (n,) and h (n,). */
void channel_points(const Channel *channel, const double *s, const double *h, ptrdiff_t n, double *points);

/* x, y, z (n, 3) of s, theta, h (n, 3); theta is atan2(y, z). */
void channel_space(const Channel *channel, const double *values, ptrdiff_t n, double *space);

/* The same of levels of values (levels, n, 3), those of each level at the numbers `ids` (n,) of `nodes` in space (levels, nodes, 3). */
void channel_nodes(const Channel *channel, const double *values, const ptrdiff_t *ids, ptrdiff_t levels, ptrdiff_t n,
                   ptrdiff_t nodes, double *space);
