/* Values between the nodes of a table, by cubics through the four nearest ones along each axis. */
#pragma once
#include <stddef.h>

/* out (count, width): values of `table` (n, m, width) at u, v (count,), in steps of the table from its first node;
   beyond the table the cubics at its ends go on. n is at least 4, m at least 4 or 1: then v has no meaning. */
void lattice_values(const double *table, ptrdiff_t n, ptrdiff_t m, ptrdiff_t width, const double *u, const double *v,
                    ptrdiff_t count, double *out);
