/* Samples of Fourier sums at a power of two of equal steps; see waves.py. */
#ifndef MESHONET_COLUMNS_H
#define MESHONET_COLUMNS_H

#include <stddef.h>

/* `columns` (count, 2, width), zeroed, real parts before imaginary ones, from `modes` (m, 2 highest + 1) in
   complex pairs, k = 0 .. highest, -highest .. -1, each times gain[|k|]; highest < count / 2, m <= width, a
   multiple of LANES. `unit` (count / 2, 2) holds exp(2 pi i j / count). */
void fourier_columns(const double *modes, ptrdiff_t m, ptrdiff_t highest, const double *gain, const double *unit,
                   double *columns, ptrdiff_t count, ptrdiff_t width);

#endif
