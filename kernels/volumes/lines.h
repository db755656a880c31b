#pragma once
#include <stddef.h>

/* Move nodes along lines of a volume, (before, n, after) in three planes, to first steps low[before][after] and last steps
   high[...]; NULL keeps that end. The change of log step k decays as exp(-k / reach). 0, or -1 without memory. */
int volume_lines(double *nodes, ptrdiff_t before, ptrdiff_t n, ptrdiff_t after, const double *low, const double *high,
                  double reach, int threads);
