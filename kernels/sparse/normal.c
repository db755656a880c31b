#include "normal.h"
#include "clones.h"

MESHONET_INLINE void terms(const Dependence *of, const double *derivatives, const double *weight, const double *slope,
                           const int b, double *values, double *right, double *sums)
{
    const ptrdiff_t *place = of->places;
    for (int i = 0; i < of->m; i++)
        for (int j = i; j < of->m; j++)
            for (ptrdiff_t k = 0; k < of->k; k++, place++) {
                if (*place < 0)
                    continue;
                const double *one = derivatives + (k * of->m + i) * b, *other = derivatives + (k * of->m + j) * b;
                double *to = values + (*place >> 1) * b * b;
                for (int r = 0; r < b; r++)
                    for (int c = 0; c < b; c++)
                        to[*place & 1 ? c * b + r : r * b + c] += weight[k] * one[r] * other[c];
            }
    for (int i = 0; i < of->m; i++) {
        for (ptrdiff_t s = 0; s < of->n * b; s++)
            sums[s] = 0.0;
        for (ptrdiff_t k = 0; k < of->k; k++)
            for (int r = 0; r < b && of->unknowns[k * of->m + i] >= 0; r++)
                sums[of->unknowns[k * of->m + i] * b + r] += slope[k] * derivatives[(k * of->m + i) * b + r];
        for (ptrdiff_t s = 0; s < of->n * b; s++)
            right[s] -= sums[s];
    }
}

void normal_terms(const Dependence *of, const double *derivatives, const double *weight, const double *slope,
                  double *values, double *right, double *sums)
{
    if (of->block == 1)
        terms(of, derivatives, weight, slope, 1, values, right, sums);
    else
        terms(of, derivatives, weight, slope, 2, values, right, sums);
}
