#include "walk.h"
#include "steps.h"

/* Twice the area to the left of a b, up to c. */
static double area(MapPoint a, MapPoint b, MapPoint c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* The edge by which the line from p to q leaves a triangle, -1 if q is in it. Of two edges with q beyond them it is the
   one that the line crosses first: their common corner lies on the other side of the line. */
static int edge_out(const MapPoint *w, MapPoint p, MapPoint q)
{
    int out[3], count = 0;
    for (int i = 0; i < 3; i++)
        if (area(w[i], w[(i + 1) % 3], q) < 0)
            out[count++] = i;
    if (count == 0)
        return -1;
    if (count == 1)
        return out[0];
    const int ordered = (out[0] + 1) % 3 == out[1], first = out[!ordered], second = out[ordered];
    return area(p, q, w[second]) > 0 ? first : second;
}

/* The point of the plane at q in a triangle, moved into it if it is outside. */
static MapPoint place(const MapPoint *w, const ptrdiff_t *corner, const MapPoint *points, MapPoint q)
{
    double part[3], sum = 0;
    MapPoint at = {0, 0};
    for (int i = 0; i < 3; i++) {
        const double a = area(w[(i + 1) % 3], w[(i + 2) % 3], q);
        sum += part[i] = a > 0 ? a : 0;
    }
    for (int i = 0; i < 3; i++) {
        const double share = sum > 0 ? part[i] / sum : 1.0 / 3.0;
        at.x += share * points[corner[i]].x, at.y += share * points[corner[i]].y;
    }
    return at;
}

void walk_map(const TriangleMap *map, const ptrdiff_t *corners, const MapPoint *points, const ptrdiff_t *start, const MapPoint *from,
              const ptrdiff_t *first, ptrdiff_t walks, const MapPoint *targets, ptrdiff_t limit, MapPoint *reached)
{
    for (ptrdiff_t k = 0; k < walks; k++) {
        ptrdiff_t f = start[k], turns = 0, left = limit;
        MapPoint p = from[k], shift = {0, 0};
        for (ptrdiff_t i = first[k]; i < first[k + 1]; i++) {
            MapPoint q = plus(turned(targets[i], turns), shift);
            for (int edge; left-- > 0 && (edge = edge_out(map->coordinates + 3 * f, p, q)) >= 0;) {
                if (map->neighbours[3 * f + edge] < 0)
                    break;
                p = across(map, f, edge, p), q = across(map, f, edge, q);
                turns = (turns + map->turns[3 * f + edge]) & 3;
                f = map->neighbours[3 * f + edge];
            }
            shift = minus(q, turned(targets[i], turns));
            reached[i] = place(map->coordinates + 3 * f, corners + 3 * f, points, q);
            p = q;
        }
    }
}
