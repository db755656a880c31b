#pragma once
#include <stddef.h>

/* Index of the nearest of n points (x, y) to each of m places (m, 2), the first of equally near ones, and the square of
   its distance. All are looked at, a block of them at a time. */
void nearest_points(const double *places, ptrdiff_t m, const double *x, const double *y, ptrdiff_t n, ptrdiff_t *index,
                    double *square);
