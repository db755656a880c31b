/* Jacobians at the corners of quads. */
#pragma once
#include <stddef.h>

/* The smallest one (m,) of each of the quads (m, 4) of `nodes` (n, 2), NaN if one is not finite. */
void smallest_corners(const double *nodes, const ptrdiff_t *quads, ptrdiff_t m, double *smallest);
