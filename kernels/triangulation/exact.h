/* Exact orientation and in-circle tests for integer coordinates of at most 30 bits.

   Differences have 31 bits, so that the determinant of the orientation fits into 63 bits, that of the circle into 125. */
#ifndef MESHONET_TRIANGULATION_EXACT_H
#define MESHONET_TRIANGULATION_EXACT_H

#include <stdint.h>

typedef struct {
    int64_t x, y;
} Node;

/* Twice the area of a b c: positive when counter-clockwise. */
static inline int64_t turn(Node a, Node b, Node c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/* A number of 128 bits, high * 2^64 + low, in two's complement. */
typedef struct {
    uint64_t high, low;
} Wide;

/* total + a b */
static inline Wide add_product(Wide total, int64_t a, int64_t b)
{
    const uint64_t half = 0xffffffffu, u = (uint64_t)a, v = (uint64_t)b;
    const uint64_t u0 = u & half, u1 = u >> 32, v0 = v & half, v1 = v >> 32;
    const uint64_t first = u0 * v0, cross = u1 * v0 + (first >> 32), other = u0 * v1 + (cross & half);
    uint64_t high = u1 * v1 + (cross >> 32) + (other >> 32);
    const uint64_t low = (other << 32) | (first & half);
    high -= (a < 0 ? v : 0) + (b < 0 ? u : 0); /* of the product without signs */
    total.low += low;
    total.high += high + (total.low < low);
    return total;
}

/* Whether d lies inside of the circle through a, b, c, which are counter-clockwise. */
static inline int in_circle(Node a, Node b, Node c, Node d)
{
    const int64_t ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
    const int64_t al = ax * ax + ay * ay, bl = bx * bx + by * by, cl = cx * cx + cy * cy;
    const int64_t ab = ax * by - ay * bx, bc = bx * cy - by * cx, ca = cx * ay - cy * ax;
    const double p = (double)al * (double)bc, q = (double)bl * (double)ca, r = (double)cl * (double)ab;
    const double size = (p < 0 ? -p : p) + (q < 0 ? -q : q) + (r < 0 ? -r : r), sum = p + q + r;
    if (sum > 1e-14 * size || sum < -1e-14 * size) /* far beyond what rounding can do to it */
        return sum > 0;
    Wide exact = {0, 0};
    exact = add_product(exact, al, bc);
    exact = add_product(exact, bl, ca);
    exact = add_product(exact, cl, ab);
    return !(exact.high >> 63) && (exact.high | exact.low);
}

#endif
