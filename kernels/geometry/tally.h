/* What there is to say of a row of values: its ends and sum, and which of them lie between two given ones. */
#pragma once
#include <stddef.h>
#include <stdint.h>

/* Least, greatest and sum of the values of a row. */
void values_reduce(const double *row, ptrdiff_t cells, double *low, double *high, double *sum);

/* Rank the values of a row against two of them: adds to counts how many are < from, <= from, < to, <= to, and
   puts those between (neither end) into caught, `room` at the most; returns how many there are. */
ptrdiff_t values_catch(const double *row, ptrdiff_t cells, double from, double to, int64_t counts[4], double *caught,
                       ptrdiff_t room);
