/* Motorcycle graph of a seamless map: rays along its coordinate lines; each ends where it meets another one. */
#pragma once
#include "lines.h"

/* Nodes at corners of triangles: node[3 f + corner] or -1; port[12 f + 4 corner + axis] is the number of the way out of
   that node through triangle f along i^axis, or -1. A node has `ports` of them at most. */
typedef struct {
    TriangleMap map;
    const ptrdiff_t *node, *port;
    ptrdiff_t nodes, ports;
    double near; /* part of an edge within which a ray meets a node */
} RayLines;

/* A ray starts at a corner of a triangle along i^axis. */
typedef struct {
    ptrdiff_t node, port, face, corner, axis, batch;
} RayStart;

enum { RAY_CANCELLED, RAY_AT_NODE, RAY_AT_RAY, RAY_AT_WALL, RAY_TOO_LONG };

/* Where a ray ended. RAY_AT_NODE: `other` is the node and `place` the port. RAY_AT_RAY: `other` is the ray it met, at `along`
   of its length, and `place` is 1 on the left of that, 3 on the right. RAY_AT_WALL: `other` is the triangle, `place` its edge
   and `along` the part of that. */
typedef struct {
    ptrdiff_t kind, other, place;
    double along, length;
} RayEnd;

/* A straight piece of a ray in one triangle, in the order in which they were drawn. */
typedef struct {
    ptrdiff_t ray, face, axis;
    MapPoint from, to;
    double length; /* of the ray up to its start */
} RayPiece;

/* Follow each ray without regard to others through `limit` triangles at the most: met[2 r] is the node that it meets and
   met[2 r + 1] the port, or -1 and -1. */
void probe_rays(const RayLines *lines, const RayStart *starts, ptrdiff_t rays, ptrdiff_t limit, ptrdiff_t *met);

/* Trace all rays, batch after batch, each at unit speed through `limit` triangles at the most. Writes where they end and
   their pieces, `room` at the most. Returns how many pieces there are, -1 if there is not enough room, -2 without
   memory. */
ptrdiff_t trace_rays(const RayLines *lines, const RayStart *starts, ptrdiff_t rays, ptrdiff_t limit, RayEnd *ends, RayPiece *pieces,
                     ptrdiff_t room);
