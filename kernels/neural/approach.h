/* Picard steps towards Winslow's grids; see approach.c. */
#pragma once
#include <stddef.h>

#define APPROACH_LINE 16 /* numbers that lines of tables are rounded up to a multiple of */

/* The transform of `count` values along an axis: a symmetric table (count, line), its own inverse, and minus the
   eigenvalues of second differences (line). Beyond `count` the table has zeros, and `values` ones. */
typedef struct {
    ptrdiff_t count, line;
    const double *table, *values;
} Waves;

/* Planes of (m, n) nodes; `around`: rows go round and are unknown but at both ends, else off the rim. `harmonic`:
   from Laplace's solution; else steps after the first are extrapolated. */
typedef struct {
    ptrdiff_t m, n;
    int around, harmonic, steps;
    double share, growth;
    Waves xi, eta;
} Approach;

/* How many numbers approach_grid needs as scratch, zeros before its first grid. */
ptrdiff_t approach_scratch(const Approach *a);

/* Move the planes p (2, m, n) in place; step (2, m, n) is the last step. `turn` (2, n) is added from one round to the
   next. */
void approach_grid(const Approach *a, double *p, const double *turn, double *scratch, double *step);
