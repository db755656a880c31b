/* Vectors in space. */
#pragma once
#include "clones.h"

typedef struct {
    double x, y, z;
} Vector;

MESHONET_INLINE Vector plus(Vector a, Vector b) { return (Vector){a.x + b.x, a.y + b.y, a.z + b.z}; }
MESHONET_INLINE Vector minus(Vector a, Vector b) { return (Vector){a.x - b.x, a.y - b.y, a.z - b.z}; }
MESHONET_INLINE Vector times(double s, Vector a) { return (Vector){s * a.x, s * a.y, s * a.z}; }
MESHONET_INLINE double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
MESHONET_INLINE Vector cross(Vector a, Vector b)
{
    return (Vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
MESHONET_INLINE double triple(Vector a, Vector b, Vector c) { return dot(a, cross(b, c)); }
