/* Sums of many numbers that are equal on every processor, independent of its vector width: number k is added to partial
   sum k mod 16, and the partial sums are added as a binary tree. */
#pragma once
#include "clones.h"
#include <stddef.h>

#define SUM_LANES 16 /* they hide how long an addition takes */

/* NAME(..., n): the sum of TERM over k from 0 to before n, in numbers of type T. */
#define MESHONET_SUM(NAME, T, TERM, ...)                                   \
    MESHONET_INLINE T NAME(__VA_ARGS__, ptrdiff_t n)                       \
    {                                                                      \
        T sum[SUM_LANES] = {0};                                                 \
        ptrdiff_t start = 0;                                               \
        for (; start + SUM_LANES <= n; start += SUM_LANES)                           \
            for (ptrdiff_t l = 0, k = start; l < SUM_LANES; l++, k = start + l) \
                sum[l] += TERM;                                            \
        for (ptrdiff_t l = 0, k = start; k < n; l++, k++)                  \
            sum[l] += TERM;                                                \
        for (int half = SUM_LANES / 2; half > 0; half /= 2)                     \
            for (int l = 0; l < half; l++)                                 \
                sum[l] += sum[l + half];                                   \
        return sum[0];                                                     \
    }

MESHONET_SUM(sum_of, double, v[k], const double *restrict v)
MESHONET_SUM(product_of, double, a[k] * b[k], const double *a, const double *b)
MESHONET_SUM(product_of_mixed, double, (double)a[k] * b[k], const float *restrict a, const double *restrict b)
MESHONET_SUM(product_of_floats, float, a[k] * b[k], const float *restrict a, const float *restrict b)
