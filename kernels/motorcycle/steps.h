/* Arithmetic of points, and the step from a triangle to its neighbour. */
#pragma once
#include "lines.h"
#include <math.h>

/* p times i^k. */
static inline MapPoint turned(MapPoint p, ptrdiff_t k)
{
    switch (k & 3) {
    case 0:
        return p;
    case 1:
        return (MapPoint){-p.y, p.x};
    case 2:
        return (MapPoint){-p.x, -p.y};
    default:
        return (MapPoint){p.y, -p.x};
    }
}

static inline MapPoint minus(MapPoint a, MapPoint b)
{
    return (MapPoint){a.x - b.x, a.y - b.y};
}

static inline MapPoint plus(MapPoint a, MapPoint b)
{
    return (MapPoint){a.x + b.x, a.y + b.y};
}

/* A point p of triangle f in the coordinates of the triangle across its edge i. */
static inline MapPoint across(const TriangleMap *map, ptrdiff_t f, ptrdiff_t i, MapPoint p)
{
    const ptrdiff_t g = map->neighbours[3 * f + i], j = map->edges[3 * f + i];
    const MapPoint here = map->coordinates[3 * f + i], there = map->coordinates[3 * g + (j + 1) % 3];
    return plus(there, turned(minus(p, here), map->turns[3 * f + i]));
}
