/* Elimination order with which the factor of a sparse symmetric matrix stays sparse. */
#pragma once
#include <stddef.h>

/* Fill `order` (n) with vertices by approximate minimum degree (Amestoy, Davis, Duff, SIAM J. Matrix Anal. Appl. 17
   (1996) 886-905). The neighbours of vertex i, without itself and each once, are list[start[i]] to list[start[i + 1]].
   Ties go to the vertex that came to its degree last, so the order is always the same. Returns 0, or -1 where memory
   ran out. */
int minimum_degree(int n, const ptrdiff_t *start, const int *list, int *order);
