/* Factors A = P^T L D L^T P of sparse symmetric matrices without pivoting; L is unit lower triangular, D diagonal. They
   exist for every order P if A is positive definite or quasi-definite (Vanderbei, SIAM J. Optim. 5 (1995) 100-113). */
#pragma once
#include <stddef.h>

/* Which entries there are, in the order of elimination. Entry (i, j), i <= j, of the matrix is in column j. */
typedef struct {
    int n;
    int *order;         /* (n,) order[k] is the unknown that is eliminated as the k-th */
    int *parent;        /* (n,) first row below the diagonal in each column of L, -1 if there is none */
    ptrdiff_t *start;   /* (n + 1,) where the entries of each column of A start */
    int *row;           /* (start[n],) their rows */
    ptrdiff_t *fill;    /* (n + 1,) where the columns of L start, diagonals left out */
} SparsePattern;

/* Fill `pattern` from m entries of the matrix, given in one triangle or the other, repeated ones adding up; slot[e] is
   where entry e is among the distinct ones. `row` has room for m. Returns 0, or -1 where memory ran out. */
int sparse_analyse(int n, ptrdiff_t m, const ptrdiff_t *rows, const ptrdiff_t *columns, SparsePattern *pattern,
                   ptrdiff_t *slot);

/* Factor the matrix of the distinct entries' `values`: `lower_row` and `lower` (fill[n],) are the rows and numbers of
   L, `pivots` (n,) those of D. Returns 0, k + 1 where the pivot of row k is zero or not finite, -1 where memory ran out. */
ptrdiff_t sparse_factor(const SparsePattern *pattern, const double *values, int *lower_row, double *lower,
                        double *pivots);

/* Solve for `sides` right sides at once, x (n, sides) in and out, scratch (n, sides). */
void sparse_solve(const SparsePattern *pattern, const int *lower_row, const double *lower, const double *pivots,
                  ptrdiff_t sides, double *x, double *scratch);

/* product (n, sides) = A x (n, sides). */
void sparse_multiply(const SparsePattern *pattern, const double *values, ptrdiff_t sides, const double *x,
                     double *product);
