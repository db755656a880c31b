/* Energy of a patch of a grid and its minimiser; see repair.c. */
#pragma once
#include <stddef.h>

typedef struct {
    ptrdiff_t ni, nj;            /* nodes; all on the rim are fixed */
    int periodic;                /* row ni - 1 repeats row 0, and both are free */
    double *x, *y;               /* (ni, nj) */
    const double *width, *height; /* (ni - 1), (nj - 1): reference lengths of the cells along xi and eta */
    double shape;                /* weight of the angle term against the harmonic one, 0 to 1 */
} Patch;

/* Doubles of workspace that repair_minimise needs. */
size_t repair_workspace(ptrdiff_t ni, ptrdiff_t nj, int periodic);

/* Energy of the patch; its gradient in gx, gy (ni, nj), zero at fixed nodes; the smallest corner Jacobian over
   reference area. `epsilon` regularises; with 0 the energy of a folded patch is infinite. `work` as above. */
double repair_energy(const Patch *patch, double epsilon, double *gx, double *gy, double *smallest, double *work);

/* Minimise in place; returns iterations done. Stops after `most`, when nodes move by less than `still` of their
   cells, or, with `until_valid`, as soon as every corner Jacobian over reference area exceeds `until_valid`. */
int repair_minimise(const Patch *patch, double epsilon, int most, double still, double until_valid, double *energy,
                    double *smallest, double *work);
