#pragma once
#include <stddef.h>

/* Distances (m,) from points (m, 2) to the nearest of walls (n, 2) ahead of them, infinite without one: a wall whose
   direction has a cosine above `cosine` to the normal, left of the unit directions `along` (m, 2), and is farther than
   `same`. */
void nearest_ahead(const double *walls, ptrdiff_t n, const double *points, const double *along, ptrdiff_t m, double cosine,
                   double same, double *distances);
