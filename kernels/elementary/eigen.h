/* Eigenvalues and eigenvectors of matrices that are not symmetric. */
#pragma once
#include <stddef.h>

/* a (n, n) = vectors diag(values) inverse, of a matrix with distinct real eigenvalues, which is overwritten; vectors
   have unit size. By QR iteration with shifts (Golub & Van Loan, Matrix Computations, 2013, chapter 7). Returns 1 where
   eigenvalues are not real, 2 without memory. */
int real_eigen(double *a, ptrdiff_t n, double *values, double *vectors, double *inverse);
