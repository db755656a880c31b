#pragma once
#include <stddef.h>

enum { nearest_block = 32 };

/* Index of the nearest of n points (x, y) to each of m places (m, 2), the first of equally near ones, and the square of
   its distance. `low` and `high` (blocks, 2) are corners of the boxes around each `nearest_block` points: of those in the
   order of a curve few boxes are as near as the nearest point so far, and only in these points are looked at. */
void nearest_points(const double *places, ptrdiff_t m, const double *x, const double *y, ptrdiff_t n, const double *low,
                    const double *high, ptrdiff_t *index, double *square);
