/* The inverse of a seamless map along straight walks. */
#pragma once
#include "lines.h"

/* Walk k starts in triangle start[k] at from[k] and visits, straight from one to the next, the points
   targets[first[k]] to targets[first[k + 1] - 1], all in coordinates of the triangle where it starts. `corners` (3 a
   triangle) number the points of the plane; `reached` gets where the visits are there. A walk that comes to the wall, or
   through `limit` triangles, stays there. */
void walk_map(const TriangleMap *map, const ptrdiff_t *corners, const MapPoint *points, const ptrdiff_t *start, const MapPoint *from,
              const ptrdiff_t *first, ptrdiff_t walks, const MapPoint *targets, ptrdiff_t limit, MapPoint *reached);
