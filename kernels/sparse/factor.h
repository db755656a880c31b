/* Factors A = P^T L D L^T P of sparse symmetric matrices without pivoting; L is unit lower triangular, D diagonal. They
   exist for every order P if A is positive definite or quasi-definite (Vanderbei, SIAM J. Optim. 5 (1995) 100-113).
   Entries are numbers or blocks of two by two, of unknowns that are eliminated together. */
#pragma once
#include <stddef.h>

/* Which entries there are, in the order of elimination. Entry (i, j), i <= j, of the matrix is in column j. */
typedef struct {
    int n;
    int block;          /* number of unknowns in a row, 1 or 2 */
    int *order;         /* (n,) order[k] is the unknown that is eliminated as the k-th */
    int *parent;        /* (n,) first row below the diagonal in each column of L, -1 if there is none */
    ptrdiff_t *start;   /* (n + 1,) where the entries of each column of A start */
    int *row;           /* (start[n],) their rows */
    ptrdiff_t *fill;    /* (n + 1,) where the columns of L start, diagonals left out */
} SparsePattern;

/* Fill `pattern` from m entries of the matrix, given in one triangle or the other, repeated ones adding up; slot[e] is
   where entry e is among the distinct ones. Rows are of `block` unknowns, 1 or 2. `row` has room for m. Returns 0, or -1
   where memory ran out. */
int sparse_analyse(int n, ptrdiff_t m, const ptrdiff_t *rows, const ptrdiff_t *columns, int block,
                   SparsePattern *pattern, ptrdiff_t *slot);

/* Factor the matrix of the distinct entries' `values` (start[n], block, block), each block with the rows of its column.
   `lower_row` (fill[n],) are the rows of L, `lower` (fill[n], block, block) its numbers, each block in columns; `pivots`
   (n, block, block) are blocks of D, factored. Returns 0, k + 1 where a pivot of row k is zero or not finite, -1 where
   memory ran out. */
ptrdiff_t sparse_factor(const SparsePattern *pattern, const double *values, int *lower_row, double *lower,
                        double *pivots);

/* Solve for `sides` right sides at once, x (n block, sides) in and out, scratch the same. */
void sparse_solve(const SparsePattern *pattern, const int *lower_row, const double *lower, const double *pivots,
                  ptrdiff_t sides, double *x, double *scratch);

/* product (n block, sides) = A x (n block, sides). */
void sparse_multiply(const SparsePattern *pattern, const double *values, ptrdiff_t sides, const double *x,
                     double *product);
