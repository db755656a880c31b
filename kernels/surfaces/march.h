#pragma once
#include "graph.h"

typedef struct {
    double explicit_smoothing, implicit_smoothing, theta;
    double outer;         /* factor of the explicit smoothing at half the size from the wall and beyond */
    double sharp;         /* cosine between the normals of faces beyond which their edge is averaged */
    double size;          /* half the size of the surface */
    double longest;       /* step over the least distance of neighbours, at most */
    double weight, blend; /* of one smoothing sweep of the volumes; how fast volumes become equal */
    ptrdiff_t sweeps, ramp; /* such sweeps; levels over which they set in */
    double tolerance;     /* of linear systems */
    ptrdiff_t most;       /* steps to a level: more are needed where cells collapse */
    double relaxing;      /* of fronts between steps, relax.h; with 0 there is none, and steps are longer */
    double settled;       /* distance over `size` at which it has set in everywhere */
    double near;          /* distance over that from a concave edge at which it has set in there */
    ptrdiff_t relaxations; /* sweeps after a step */
} SurfaceMarch;

typedef struct {
    ptrdiff_t levels;     /* that were made, the wall not counted */
    ptrdiff_t steps, iterations;
} SurfaceMarched;

/* Fill levels 1 .. count of `levels` (count + 1, 3, nodes) from level 0, `heights` (count) of which are apart from the
   wall. Returns 0, or -1 without memory. */
int surface_march(double *levels, const double *heights, ptrdiff_t count, const Graph *graph,
                  const SurfaceMarch *settings, int threads, SurfaceMarched *made);
