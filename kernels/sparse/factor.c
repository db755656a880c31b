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

/* e = D^-1 y for each of the rows of y (b, b), where `pivot` is D, factored. */
MESHONET_INLINE void divide(const double *pivot, const double *y, const int rows, const int b, double *e)
{
    for (int r = 0; r < rows; r++)
        if (b == 1) {
            e[r] = y[r] / pivot[0];
        } else {
            e[2 * r + 1] = (y[2 * r + 1] - pivot[2] * y[2 * r]) / pivot[3];
            e[2 * r] = y[2 * r] / pivot[0] - pivot[2] * e[2 * r + 1];
        }
}

/* Factor D (b, b) in place; return whether a pivot is zero or not finite. */
MESHONET_INLINE int divisible(double *pivot, const int b)
{
    if (b == 2) {
        const double below = pivot[2];
        pivot[2] = below / pivot[0];
        pivot[3] -= pivot[2] * below;
    }
    return pivot[0] != 0.0 && isfinite(pivot[0]) && pivot[b * b - 1] != 0.0 && isfinite(pivot[b * b - 1]);
}

/* Two doubles in a register; see lanes.h. */
typedef double Pair __attribute__((vector_size(16), aligned(8), may_alias));
#define PAIR(p) (*(Pair *)(p))
#define PAIR_OF(p) (*(const Pair *)(p))

/* y -= yi l^T for each of `count` blocks l (b, b) of a column, in columns, and the block y of its row. */
MESHONET_INLINE void subtract(const double *restrict l, const int *restrict row, ptrdiff_t count,
                              const double *yi, const int b, double *restrict y)
{
    for (ptrdiff_t p = 0; p < count; p++, l += b * b) {
        double *to = y + (ptrdiff_t)row[p] * b * b;
        if (b == 1) {
            to[0] -= l[0] * yi[0];
        } else {
            const Pair left = PAIR_OF(l), right = PAIR_OF(l + 2);
            PAIR(to) = PAIR(to) - left * yi[0] - right * yi[1];
            PAIR(to + 2) = PAIR(to + 2) - left * yi[2] - right * yi[3];
        }
    }
}

MESHONET_INLINE ptrdiff_t factor(const SparsePattern *a, const double *values, const int b, int *lower_row,
                                 double *lower, double *pivots)
{
    const int n = a->n, size = b * b;
    ptrdiff_t bad = 0;
    int *seen = malloc(((size_t)n * 3 + 1) * sizeof *seen), *list = NULL, *path = NULL;
    ptrdiff_t *end = malloc(((size_t)n + 1) * sizeof *end);
    double *y = calloc(((size_t)n + 1) * (size_t)size, sizeof *y);
    if (!seen || !end || !y)
        bad = -1;
    else
        list = seen + n, path = list + n;
    for (int k = 0; k < n && !bad; k++)
        seen[k] = -1;
    for (int k = 0; k < n && !bad; k++) {
        const int first = reach(a, k, seen, list, path);
        double *pivot = pivots + (ptrdiff_t)k * size;
        for (ptrdiff_t e = a->start[k]; e < a->start[k + 1]; e++)
            for (int s = 0; s < size; s++)
                y[(ptrdiff_t)a->row[e] * size + s] += values[e * size + s];
        for (int s = 0; s < size; s++) {
            pivot[s] = y[(ptrdiff_t)k * size + s];
            y[(ptrdiff_t)k * size + s] = 0.0;
        }
        end[k] = a->fill[k];
        for (int m = first; m < n; m++) {
            const ptrdiff_t i = list[m];
            double yi[4], entry[4];
            for (int s = 0; s < size; s++) {
                yi[s] = y[i * size + s];
                y[i * size + s] = 0.0;
            }
            divide(pivots + i * size, yi, b, b, entry);
            subtract(lower + a->fill[i] * size, lower_row + a->fill[i], end[i] - a->fill[i], yi, b, y);
            for (int q = 0; q < b; q++)
                for (int r = 0; r < b; r++)
                    for (int c = 0; c < b; c++)
                        pivot[r * b + c] -= entry[r * b + q] * yi[c * b + q];
            lower_row[end[i]] = k;
            for (int q = 0; q < b; q++)
                for (int r = 0; r < b; r++)
                    lower[end[i] * size + q * b + r] = entry[r * b + q];
            end[i]++;
        }
        if (!divisible(pivot, b))
            bad = k + 1;
    }
    free(seen);
    free(end);
    free(y);
    return bad;
}

MESHONET_CLONES
ptrdiff_t sparse_factor(const SparsePattern *a, const double *values, int *lower_row, double *lower, double *pivots)
{
    return a->block == 1 ? factor(a, values, 1, lower_row, lower, pivots) : factor(a, values, 2, lower_row, lower, pivots);
}

/* Solve for one right side or two, which begin `sides` numbers after those of the row before. */
MESHONET_INLINE void solve(const SparsePattern *a, const int *lower_row, const double *lower, const double *pivots,
                           const int b, ptrdiff_t sides, const int count, double *x)
{
    const int n = a->n, size = b * b;
    double own[4], divided[4];
    for (ptrdiff_t k = 0; k < n; k++) {
        for (int c = 0; c < count; c++)
            for (int q = 0; q < b; q++)
                own[c * b + q] = x[(k * b + q) * sides + c];
        for (ptrdiff_t p = a->fill[k]; p < a->fill[k + 1]; p++)
            for (int c = 0; c < count; c++)
                for (int q = 0; q < b; q++)
                    for (int r = 0; r < b; r++)
                        x[((ptrdiff_t)lower_row[p] * b + r) * sides + c] -= lower[p * size + q * b + r] * own[c * b + q];
    }
    for (ptrdiff_t k = n - 1; k >= 0; k--) {
        for (int c = 0; c < count; c++)
            for (int q = 0; q < b; q++)
                divided[c * b + q] = x[(k * b + q) * sides + c];
        divide(pivots + k * size, divided, count, b, own);
        for (ptrdiff_t p = a->fill[k]; p < a->fill[k + 1]; p++)
            for (int c = 0; c < count; c++)
                for (int q = 0; q < b; q++)
                    for (int r = 0; r < b; r++)
                        own[c * b + q] -= lower[p * size + q * b + r] * x[((ptrdiff_t)lower_row[p] * b + r) * sides + c];
        for (int c = 0; c < count; c++)
            for (int q = 0; q < b; q++)
                x[(k * b + q) * sides + c] = own[c * b + q];
    }
}

void sparse_solve(const SparsePattern *a, const int *lower_row, const double *lower, const double *pivots,
                  ptrdiff_t sides, double *x, double *scratch)
{
    const ptrdiff_t b = a->block, row = b * sides;
    for (int k = 0; k < a->n; k++)
        for (ptrdiff_t c = 0; c < row; c++)
            scratch[k * row + c] = x[a->order[k] * row + c];
    ptrdiff_t side = 0;
    if (b == 1 && sides <= 2) { /* known to the compiler */
        if (sides == 1)
            solve(a, lower_row, lower, pivots, 1, 1, 1, scratch);
        if (sides == 2)
            solve(a, lower_row, lower, pivots, 1, 2, 2, scratch);
        side = sides;
    }
    for (; b == 1 && side + 2 <= sides; side += 2)
        solve(a, lower_row, lower, pivots, 1, sides, 2, scratch + side);
    for (; side < sides; side++)
        if (b == 1)
            solve(a, lower_row, lower, pivots, 1, sides, 1, scratch + side);
        else
            solve(a, lower_row, lower, pivots, 2, sides, 1, scratch + side);
    for (int k = 0; k < a->n; k++)
        for (ptrdiff_t c = 0; c < row; c++)
            x[a->order[k] * row + c] = scratch[k * row + c];
}

void sparse_multiply(const SparsePattern *a, const double *values, ptrdiff_t sides, const double *x, double *product)
{
    const int b = a->block;
    for (ptrdiff_t k = 0; k < a->n * b * sides; k++)
        product[k] = 0.0;
    for (int k = 0; k < a->n; k++)
        for (ptrdiff_t e = a->start[k]; e < a->start[k + 1]; e++)
            for (int s = 0; s < b * b; s++) { /* of a diagonal block both triangles are given */
                const ptrdiff_t i = ((ptrdiff_t)a->order[a->row[e]] * b + s % b) * sides;
                const ptrdiff_t j = ((ptrdiff_t)a->order[k] * b + s / b) * sides;
                for (ptrdiff_t c = 0; c < sides; c++) {
                    product[i + c] += values[e * b * b + s] * x[j + c];
                    if (a->row[e] != k)
                        product[j + c] += values[e * b * b + s] * x[i + c];
                }
            }
}
