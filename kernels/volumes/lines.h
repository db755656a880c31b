#pragma once
#include <stddef.h>

/* Lines of nodes along one direction of a volume, of (before, n, after) nodes in three planes: each is moved along
   itself until its first step is low[before][after], its last high[...], lengths; a NULL leaves that end as it is. Steps
   further on change by less, exp(-k / reach) of it in their logarithm. 0, or -1 without memory. */
int volume_lines(double *nodes, ptrdiff_t before, ptrdiff_t n, ptrdiff_t after, const double *low, const double *high,
                  double reach, int threads);
