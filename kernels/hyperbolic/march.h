#pragma once
#include <stddef.h>

typedef struct {
    double dissipation; /* coefficient of the second difference along a level */
    double even;        /* how far that difference is one of the nodes' index (1), not of arc length (0) */
    double tolerated;   /* relative difference of neighbouring edges beyond which their spacing is evened out */
    double bend;        /* coefficient of the smoothing by curvature that grows with the height */
    double implicit;    /* 1 + theta: weight of the flux along the new level */
    double volume;      /* weight of one smoothing step of the volumes */
    ptrdiff_t sweeps;   /* such steps a level, fewer next to the wall */
    ptrdiff_t rise;     /* levels over which the dissipation grows */
} MarchSettings;

/* Ends of levels that do not close: each moves along a straight line as far as its neighbour does along it. */
typedef struct {
    double first_x, first_y, last_x, last_y; /* unit directions of the lines */
} MarchEnds;

/* Doubles of scratch that a march over n nodes a level needs. */
size_t hyperbolic_scratch(ptrdiff_t n);

/* March levels 1 .. levels of the planes x and y (levels + 1, n) from level 0; see march.c.
   `ends` is NULL for closed levels. `widening` (n) multiplies the steps, less and less from the wall on, `ratios` (n)
   the ratio of one step to the one before; either may be NULL. The result is the same for any number of threads. */
void hyperbolic_march(double *x, double *y, ptrdiff_t n, ptrdiff_t levels, const double *steps, const double *widening,
                      const double *ratios, const MarchEnds *ends, const MarchSettings *settings, int threads,
                      double *scratch);
