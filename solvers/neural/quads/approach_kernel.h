/* Picard steps towards Winslow's grids; see approach_kernel.c. */
#ifndef MESHONET_APPROACH_KERNEL_H
#define MESHONET_APPROACH_KERNEL_H
#include <stddef.h>

#define APPROACH_WIDTH 16 /* rows of what is transformed are rounded up to a multiple of so many numbers */

/* Planes of (m, n) nodes, the unknown ones off the rim; `around`, m rows that go round, unknown but at both ends.
   `left` (rows, rows) and `right` (width, width) are the transforms, with zeros beyond the n - 2 unknown columns,
   `slow` (rows) and `fast` (width) minus the eigenvalues of second differences. Before the steps comes Laplace's
   solution when `harmonic`; else the steps after the first are extrapolated. */
typedef struct {
    ptrdiff_t m, n, rows, width;
    int around, harmonic, steps;
    double share, growth;
    const double *left, *right, *slow, *fast;
} Approach;

/* How many numbers approach_grid needs as scratch. */
ptrdiff_t approach_scratch(const Approach *a);

/* Move the planes p (2, m, n) in place; step (2, m, n) is the last step. `turn` (2, n) is added from one round to the
   next. */
void approach_grid(const Approach *a, double *p, const double *turn, double *scratch, double *step);
#endif
