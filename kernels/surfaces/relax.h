/* A front made even between steps, where it comes out of a concave edge. */
#pragma once
#include "solve.h"

typedef struct {
    double way;   /* a node goes the part way/edge of the way to the mean of its neighbours, half at the most */
    double away;  /* how far that has set in everywhere */
    double near;  /* it has set in up to this distance from a concave edge, and less beyond, by its square */
} Relaxing;

/* Relax the front once: each node goes a part of the way to the mean of its neighbours, along the front, so that
   squeezed cells spread, and outwards, so that hollows fill, but not inwards, so that convex edges stay. `moves`
   (3, nodes) is room. Called by all members of a team, each for its chunks. */
void relax_front(Solver *solver, double *moves, const Relaxing *relaxing, Range chunks, Member member);
/* Reach as half the shorter pair of opposite edges, in place of their mean, for nodes first .. last - 1; the least. */
double nearest_reach(const Step *step, ptrdiff_t first, ptrdiff_t last);
