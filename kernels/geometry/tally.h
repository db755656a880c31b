/* Statistics of a row of values. */
#pragma once
#include <stddef.h>

/* Least, greatest and sum of the values of a row. */
void values_reduce(const double *row, ptrdiff_t cells, double *low, double *high, double *sum);

/* Where in the row `value` stands first; it does. */
ptrdiff_t value_place(const double *row, ptrdiff_t cells, double value);
