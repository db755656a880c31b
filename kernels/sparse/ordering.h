/* Elimination order with which the factor of a sparse symmetric matrix stays sparse. */
#pragma once
#include <stddef.h>

/* Fill `order` (n) by approximate minimum degree (Amestoy, Davis, Duff, SIAM J. Matrix Anal. Appl. 17 (1996) 886-905);
   vertex i has the neighbours list[start[i]] to list[start[i + 1]]. Ties go to the vertex that came to its degree
   last. Returns 0, or -1 where memory ran out. */
int minimum_degree(int n, const ptrdiff_t *start, const int *list, int *order);
