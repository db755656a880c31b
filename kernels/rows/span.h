/* Functions of the height between hub and casing, as sums of Chebyshev polynomials. */
#pragma once
#include <stddef.h>

/* out (levels, n) = sums of c (terms, n) times Chebyshev polynomials of 2 h - 1, terms > 1, at heights h (levels, lines).
   `lines` divides n: so many functions in a row have one height. */
void chebyshev_sums(const double *c, ptrdiff_t terms, ptrdiff_t n, const double *heights, ptrdiff_t levels,
                    ptrdiff_t lines, double *out);
