/* The variational functional of a grid and its gradient; see variational_kernel.c. */
#ifndef MESHONET_VARIATIONAL_KERNEL_H
#define MESHONET_VARIATIONAL_KERNEL_H
#include <stddef.h>

typedef struct {
    double aspect;     /* a: reference ratio of eta steps to xi steps */
    double shape;      /* w: weight of the angle term against the harmonic one, 0 to 1 */
    double smoothness; /* β: weight of the edge length term */
} Weights;

/* Doubles of workspace for ni x nj nodes. */
size_t variational_workspace(ptrdiff_t ni, ptrdiff_t nj);

/* Return the functional of the nodes x, y (ni, nj); its gradient in gx, gy, zero on the rim; the smallest corner
   Jacobian. With epsilon (an area) Jacobians are regularised; with 0 the value of a folded grid is infinite. */
double variational_energy(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, const Weights *weights,
                          double epsilon, double *gx, double *gy, double *smallest, double *work);
#endif
