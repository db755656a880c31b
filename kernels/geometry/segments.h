/* Segments of a polygon that meet though they are not neighbours: sweep, compare boxes, then orient. */
#pragma once
#include <stddef.h>

/* Segment k runs from point k of n to the next, and from low[k] to top[k] along the direction of the sweep; `order` (m)
   sorts the segments by `low`. Writes `pairs`, `limit` at the most, after at most `*budget` comparisons, which are
   taken off; returns how many there are. A negative budget tells that not all were compared. */
ptrdiff_t crossing_segments(const double *points, ptrdiff_t n, const ptrdiff_t *order, ptrdiff_t m, const double *low,
                            const double *top, ptrdiff_t limit, long long *budget, ptrdiff_t *pairs);
