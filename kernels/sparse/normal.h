/* Normal equations of sums of squares. */
#pragma once
#include <stddef.h>

/* Which unknowns k residuals depend on, m each, and where products of their derivatives go. */
typedef struct {
    ptrdiff_t n, k;
    int m, block;
    const ptrdiff_t *unknowns; /* (k, m), -1 for those that are fixed */
    const ptrdiff_t *places;   /* (m (m + 1) / 2, k): twice the entry of each pair of them, in the order of numpy.triu_indices,
                                  and one more where the first is eliminated before the second; -1 where one is fixed */
} Dependence;

/* Add products of `derivatives` (k, m, block) times `weight` (k) to `values`, entries (block, block), and subtract
   derivatives times `slope` (k) from `right` (n, block), first the sum of those by the first of the m unknowns; `sums`
   (n, block) is scratch. */
void normal_terms(const Dependence *of, const double *derivatives, const double *weight, const double *slope,
                  double *values, double *right, double *sums);
