/* Per-cell measures of a structured grid; see geometry/_cells.pyx for the meaning of each argument. */
#ifndef MESHONET_CELLS_KERNEL_H
#define MESHONET_CELLS_KERNEL_H

#include <stddef.h>
#include <stdint.h>

enum { MAX_ANGLE, MIN_ANGLE, SKEWNESS, SCALED_JACOBIAN, ASPECT_RATIO, ORTHOGONALITY, AREA_RATIO, METRICS };

ptrdiff_t cells_folded_in_row(const double *x, const double *y, ptrdiff_t nj, ptrdiff_t cells);
ptrdiff_t cells_list_folded(const double *x, const double *y, ptrdiff_t ni, ptrdiff_t nj, int64_t *pairs, ptrdiff_t room);
void cells_areas(const double *x, const double *y, ptrdiff_t nj, double *area);
void cells_row(const double *x, const double *y, ptrdiff_t nj, const double *before, const double *here,
               const double *after, double *out);
void cells_reduce(const double *row, ptrdiff_t cells, double *low, double *high, double *sum);
ptrdiff_t cells_catch(const double *row, ptrdiff_t cells, double from, double to, int64_t counts[4], double *caught, ptrdiff_t room);

#endif
