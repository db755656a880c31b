/* Largest edge lengths at walls. */
#ifndef MESHONET_TRIANGULATION_WALLS_H
#define MESHONET_TRIANGULATION_WALLS_H

#include <stddef.h>

/* Points (n, 2) on walls with their normals (n, 2). Each is on a piece from a corner to the next; `beside` (n, 2) are
   the pieces before and behind that, `corner` (n, 2) the distances along the wall to the corners between them. */
typedef struct {
    ptrdiff_t n;
    const double *points, *normals, *corner;
    const ptrdiff_t *piece, *beside;
} WallPoints;

/* Lower each of `size` (n) to `part` of the distance to the nearest point within the cone around the normal whose
   cosine is `cone`. Not counted is what lies round a corner and farther than that, which every wide corner has. 0, or
   -1 without memory. */
int wall_gaps(const WallPoints *wall, double part, double cone, double *size);

/* Lower each of `size` (n) to the least of size + growth * distance over all points. */
int wall_growth(const double *points, ptrdiff_t n, double growth, double *size);

#endif
