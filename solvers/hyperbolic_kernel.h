#ifndef MESHONET_HYPERBOLIC_KERNEL_H
#define MESHONET_HYPERBOLIC_KERNEL_H
#include <stddef.h>

typedef struct {
    double dissipation; /* coefficient of the second difference along a level */
    double implicit;    /* 1 + theta: weight of the flux along the new level */
    double volume;      /* weight of one smoothing step of the volumes */
    ptrdiff_t sweeps;   /* such steps a level */
    ptrdiff_t rise;     /* levels over which the dissipation grows */
} MarchSettings;

/* Doubles of scratch that a march over n nodes a level needs. */
size_t hyperbolic_scratch(ptrdiff_t n);

/* March levels 1 .. levels of the planes x and y (levels + 1, n) from level 0; see hyperbolic_kernel.c. */
void hyperbolic_march(double *x, double *y, ptrdiff_t n, ptrdiff_t levels, const double *steps,
                      const MarchSettings *settings, double *scratch);
#endif
