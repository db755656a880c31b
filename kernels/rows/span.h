/* Functions of the height between hub and casing, as sums of Chebyshev polynomials. */
#pragma once
#include <stddef.h>

/* out (levels, n) = sums of c (terms, n) times Chebyshev polynomials of 2 h - 1, terms > 1, at heights h (levels, lines).
   `lines` divides n: so many functions in a row have one height. */
void chebyshev_sums(const double *c, ptrdiff_t terms, ptrdiff_t n, const double *heights, ptrdiff_t levels,
                    ptrdiff_t lines, double *out);

/* Parts (count, n) of the way along lines at which their arc lengths are the parts `keys` (count,) of the whole, and less
   these. `behind` and `slope` (count, n) are coefficients as above: of what an arc is ahead of the part of the way, and of its
   derivative. */
void way_ahead(const double *behind, const double *slope, const double *keys, ptrdiff_t count, ptrdiff_t n, double *parts);

/* Nodes (levels, count, 3) with the numbers `ids` (n,) of each level, as a block (3, n, levels). */
void stacked_block(const double *nodes, ptrdiff_t levels, ptrdiff_t count, const ptrdiff_t *ids, ptrdiff_t n, double *block);
