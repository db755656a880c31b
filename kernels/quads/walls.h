/* Nodes that slide along the closed curves that bound a domain. */
#pragma once
#include "geometry/curve.h"

/* A closed curve as curve.h has it, in the units of the nodes, its `end` its first point; `turned` (n + 1) is how far
   the curve has turned, in absolute angles, at the start of each interval, corners left out. Its nodes and the edges
   between them are those from `first_node` to `last_node` and from `first_edge` to `last_edge`. */
typedef struct {
    ArcLengths lengths;
    const double *cubic, *end, *turned;
    ptrdiff_t first_node, last_node, first_edge, last_edge;
} WallLoop;

/* Wall nodes by loop: their numbers, their unknowns or -1 for nodes that stay. Edges (e, 2) lead from a wall node to the
   next in the direction of the curve, `round` (e) is what the second's arc length lacks. `arc`, `tangent` (n, 2) and
   what follows are filled: points of the curve, how fast it turns, and room. */
typedef struct {
    ptrdiff_t nodes, loops;
    const WallLoop *loop;
    const ptrdiff_t *node, *unknown, *edge;
    const double *round;
    double *arc, *tangent, *turned, *turning, *force, *place, *point;
    ptrdiff_t *interval;
} Walls;

/* Put the nodes x (nodes of the mesh, 2) that slide at their arc lengths; find tangents and turning, of loops without
   such nodes only the first time. */
void walls_place(const Walls *walls, double *x, int first_time);

/* Return `weight` times the sum over wall edges of the squares (and sixth powers) of what they turn by beyond `allowed`,
   and its derivative by the arc lengths in `force`; infinite where nodes are out of order. */
double walls_energy(const Walls *walls, double weight, double allowed);
