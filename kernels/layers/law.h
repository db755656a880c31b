/* The law of layers: sizes of cells of which the logarithm is a quadratic function of their index. */
#pragma once
#include <stddef.h>

/* Of `rows` cells, at k from 0 to 1, the logarithm over the first is slope k + bend k (1 - k), so that they add up to a
   length: `wanted` (n,) times the first. The slope ends at `slopes` (n,), if that is infinite at the one of a constant
   ratio. Where the slope anywhere is less than 0 or more than the larger of `most` and (1 + `steeper`) times that of a
   constant ratio, the bend is bounded and the slope follows. `cells` (n, rows) become the sizes over the first. */
void layer_law(const double *wanted, const double *slopes, ptrdiff_t n, ptrdiff_t rows, double most, double steeper,
               double *cells);
