#ifndef MESHONET_REDISTRIBUTE_H
#define MESHONET_REDISTRIBUTE_H
#include <stddef.h>

/* Move the nodes of every line of the planes x and y (ni, nj) along it; see redistribute.c. */
void redistribute_lines(double *x, double *y, ptrdiff_t ni, ptrdiff_t nj, const double *first, const double *fade,
                        double *scratch);
#endif
