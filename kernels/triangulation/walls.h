/* How long edges at walls may be. */
#ifndef MESHONET_TRIANGULATION_WALLS_H
#define MESHONET_TRIANGULATION_WALLS_H

#include <stddef.h>

/* Lower each of `size` (n) to `part` of the distance to the nearest of the points (n, 2) within the cone around the
   normal (n, 2) whose cosine is `cone`. 0, or -1 without memory. */
int wall_gaps(const double *points, const double *normals, ptrdiff_t n, double part, double cone, double *size);

/* Lower each of `size` (n) to the least of size + growth * distance over all points. */
int wall_growth(const double *points, ptrdiff_t n, double growth, double *size);

#endif
