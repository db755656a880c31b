/* Elementary functions of arrays, products of matrices and linear systems, the same to the bit on every processor. */
#pragma once
#include <stddef.h>

typedef void (*Function)(const double *x, ptrdiff_t n, double *out);

/* The function of this name, or NULL. */
Function function_named(const char *name);

/* Angles of (x, y), as atan2. */
void function_angle(const double *y, const double *x, ptrdiff_t n, double *out);

/* x to the power y. */
void function_power(const double *x, const double *y, ptrdiff_t n, double *out);

/* out (rows, columns) = a (rows, inner) b (inner, columns), all in rows. */
void matrix_product(const double *a, const double *b, ptrdiff_t rows, ptrdiff_t inner, ptrdiff_t columns, double *out);

/* Solve a system by Gaussian elimination with partial pivoting: `right` (n, columns) becomes the solution, and the
   matrix (n, n) its factors. Return 0 where a pivot is zero. */
int solve_system(double *matrix, ptrdiff_t n, double *right, ptrdiff_t columns);
