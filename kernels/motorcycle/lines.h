/* Straight lines over the triangles of a seamless map, whose coordinates jump by quarter turns and shifts across edges. */
#pragma once
#include <stddef.h>

typedef struct {
    double x, y;
} MapPoint;

/* Triangle f has corners 0, 1, 2 counter-clockwise with coordinates[3 f + corner]; its edge i runs from corner i to the
   next. Across it lies triangle neighbours[3 f + i] (-1: none) with its edge edges[3 f + i], and what is w here is
   i^turns w + a shift there. */
typedef struct {
    ptrdiff_t triangles;
    const MapPoint *coordinates;
    const ptrdiff_t *neighbours, *edges, *turns;
} TriangleMap;
