/* Row by row (Davis, ACM Trans. Math. Softw. 31 (2005) 587-591): row k of L solves L D l = a with the rows above it,
   and the elimination tree says which of its entries are not zero. */
#include "factor.h"
#include "clones.h"

#include <math.h>
#include <stdlib.h>

/* The columns in which row k has entries, each before those that it changes, in list[first] to list[n - 1]. */
static int reach(const SparsePattern *a, int k, int *seen, int *list, int *path)
{
    int first = a->n;
    seen[k] = k;
    for (ptrdiff_t e = a->start[k]; e < a->start[k + 1]; e++) {
        int length = 0;
        for (int i = a->row[e]; seen[i] != k; i = a->parent[i]) {
            path[length++] = i;
            seen[i] = k;
        }
        while (length > 0)
            list[--first] = path[--length];
    }
    return first;
}

ptrdiff_t sparse_factor(const SparsePattern *a, const double *values, int *lower_row, double *lower, double *pivots)
{
    const int n = a->n;
    ptrdiff_t bad = 0;
    int *seen = malloc(((size_t)n * 3 + 1) * sizeof *seen), *list = NULL, *path = NULL;
    ptrdiff_t *end = malloc(((size_t)n + 1) * sizeof *end);
    double *y = calloc((size_t)n + 1, sizeof *y);
    if (!seen || !end || !y)
        bad = -1;
    else
        list = seen + n, path = list + n;
    for (int k = 0; k < n && !bad; k++)
        seen[k] = -1;
    for (int k = 0; k < n && !bad; k++) {
        const int first = reach(a, k, seen, list, path);
        for (ptrdiff_t e = a->start[k]; e < a->start[k + 1]; e++)
            y[a->row[e]] += values[e];
        double pivot = y[k];
        y[k] = 0.0;
        end[k] = a->fill[k];
        for (int m = first; m < n; m++) {
            const int i = list[m];
            const double yi = y[i], entry = yi / pivots[i];
            y[i] = 0.0;
            for (ptrdiff_t p = a->fill[i]; p < end[i]; p++)
                y[lower_row[p]] -= lower[p] * yi;
            pivot -= entry * yi;
            lower_row[end[i]] = k;
            lower[end[i]++] = entry;
        }
        pivots[k] = pivot;
        if (pivot == 0.0 || !isfinite(pivot))
            bad = k + 1;
    }
    free(seen);
    free(end);
    free(y);
    return bad;
}

/* Solve for one right side or two, which begin `sides` numbers after those of the row before. */
MESHONET_INLINE void solve(const SparsePattern *a, const int *lower_row, const double *lower, const double *pivots,
                           ptrdiff_t sides, const int count, double *x)
{
    const int n = a->n;
    double own[2];
    for (int k = 0; k < n; k++) {
        for (int c = 0; c < count; c++)
            own[c] = x[k * sides + c];
        for (ptrdiff_t p = a->fill[k]; p < a->fill[k + 1]; p++)
            for (int c = 0; c < count; c++)
                x[lower_row[p] * sides + c] -= lower[p] * own[c];
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int c = 0; c < count; c++)
            own[c] = x[k * sides + c] / pivots[k];
        for (ptrdiff_t p = a->fill[k]; p < a->fill[k + 1]; p++)
            for (int c = 0; c < count; c++)
                own[c] -= lower[p] * x[lower_row[p] * sides + c];
        for (int c = 0; c < count; c++)
            x[k * sides + c] = own[c];
    }
}

void sparse_solve(const SparsePattern *a, const int *lower_row, const double *lower, const double *pivots,
                  ptrdiff_t sides, double *x, double *scratch)
{
    for (int k = 0; k < a->n; k++)
        for (ptrdiff_t c = 0; c < sides; c++)
            scratch[k * sides + c] = x[a->order[k] * sides + c];
    ptrdiff_t side = 0;
    if (sides == 2) { /* known to the compiler */
        solve(a, lower_row, lower, pivots, 2, 2, scratch);
        side = 2;
    }
    for (; side + 2 <= sides; side += 2)
        solve(a, lower_row, lower, pivots, sides, 2, scratch + side);
    if (side < sides)
        solve(a, lower_row, lower, pivots, sides, 1, scratch + side);
    for (int k = 0; k < a->n; k++)
        for (ptrdiff_t c = 0; c < sides; c++)
            x[a->order[k] * sides + c] = scratch[k * sides + c];
}

void sparse_multiply(const SparsePattern *a, const double *values, ptrdiff_t sides, const double *x, double *product)
{
    for (ptrdiff_t k = 0; k < a->n * sides; k++)
        product[k] = 0.0;
    for (int k = 0; k < a->n; k++)
        for (ptrdiff_t e = a->start[k]; e < a->start[k + 1]; e++) {
            const ptrdiff_t i = a->order[a->row[e]] * sides, j = a->order[k] * sides;
            for (ptrdiff_t c = 0; c < sides; c++) {
                product[i + c] += values[e] * x[j + c];
                if (i != j)
                    product[j + c] += values[e] * x[i + c];
            }
        }
}
