/* What a descent remembers of its steps, and the direction that comes of it.

   Steps s and preconditioned changes z = P y of the gradient are the rows of one table, read once for the products
   with the gradient and once for the new direction; the two-loop recursion runs on the small tables of the products
   s·y and y·z. Rows are in single precision: they steer the descent, they are not its result.

   Nocedal and Wright, Numerical Optimization (2006), algorithm 7.4; the form in products: Chen, Wang and Zhou,
   NIPS 27 (2014). */
#pragma once
#include "clones.h"
#include "variational.h"
#include <math.h>
#include <string.h>

#define CHUNK 2048 /* values of every row of the table that are read together */

/* Products of every row of the table (2 count, n) with v. */
MESHONET_CLONES
static void row_products(const float *table, int rows, const double *v, ptrdiff_t n, double *products)
{
    for (int r = 0; r < rows; r++)
        products[r] = 0.0;
    for (ptrdiff_t start = 0; start < n; start += CHUNK) {
        const ptrdiff_t stop = start + CHUNK < n ? start + CHUNK : n;
        for (int r = 0; r < rows; r++) {
            const float *restrict row = table + r * n;
            double sum = 0.0;
            for (ptrdiff_t k = start; k < stop; k++)
                sum += (double)row[k] * v[k];
            products[r] += sum;
        }
    }
}

/* direction = Σ share[r] row r - scale steepest. */
MESHONET_CLONES
static void row_sum(const float *table, int rows, const float *share, const float *restrict steepest, float scale,
                    ptrdiff_t n, float *restrict direction)
{
    for (ptrdiff_t start = 0; start < n; start += CHUNK) {
        const ptrdiff_t stop = start + CHUNK < n ? start + CHUNK : n;
        for (ptrdiff_t k = start; k < stop; k++)
            direction[k] = -scale * steepest[k];
        for (int r = 0; r < rows; r++) {
            const float *restrict row = table + r * n, factor = share[r];
            for (ptrdiff_t k = start; k < stop; k++)
                direction[k] += factor * row[k];
        }
    }
}

/* The direction -H g from the gradient and P g, and its slope. */
static double choose_direction(Descent *d)
{
    const ptrdiff_t n = 2 * d->spectrum.mi * d->spectrum.mj;
    const int count = d->count, *order = d->order;
    const double *products = d->products;
    double alpha[PAIRS], rest[PAIRS], scale = 1.0, slope;
    float share[2 * PAIRS] = {0};
    if (count > 0)
        scale = d->sy[order[count - 1]][order[count - 1]] / d->yz[order[count - 1]][order[count - 1]];
    for (int k = count - 1; k >= 0; k--) {
        double sum = products[2 * order[k]];
        for (int l = k + 1; l < count; l++)
            sum -= d->sy[order[k]][order[l]] * alpha[l];
        alpha[k] = sum / d->sy[order[k]][order[k]];
    }
    for (int k = 0; k < count; k++) {
        double sum = products[2 * order[k] + 1];
        for (int l = 0; l < count; l++)
            sum -= d->yz[order[k]][order[l]] * alpha[l];
        sum *= scale;
        for (int l = 0; l < k; l++)
            sum += rest[l] * d->sy[order[l]][order[k]];
        rest[k] = alpha[k] - sum / d->sy[order[k]][order[k]];
    }
    for (int k = 0; k < count; k++)
        share[2 * order[k]] = (float)-rest[k], share[2 * order[k] + 1] = (float)(scale * alpha[k]);
    row_sum(d->table, 2 * count, share, d->steepest, (float)scale, n, d->direction);
    row_products(d->direction, 1, d->gradient, n, &slope);
    return slope;
}

/* Add the step, whose slope was `slope`, the gradient's change y and P y, unless the functional bends down along the
   step; then the products of all rows with the new gradient. Those with y are the changes of these. */
MESHONET_CLONES
static void remember(Descent *d, double factor, double slope)
{
    const ptrdiff_t n = 2 * d->spectrum.mi * d->spectrum.mj;
    const double *restrict old = d->gradient, *restrict fresh = d->fresh;
    double before[2 * PAIRS], steps = 0.0, changes = 0.0, curvature = 0.0, turned = 0.0;
    const float *restrict step = d->direction;
    for (ptrdiff_t k = 0; k < n; k++) {
        const double s = (double)step[k], y = fresh[k] - old[k];
        steps += s * s, changes += y * y, curvature += s * y;
        turned += old[k] * (double)(d->turned[k] - d->steepest[k]);
    }
    const int bends = curvature > 1e-12 * sqrt(steps * changes);
    int slot = d->count;
    memcpy(before, d->products, sizeof before);
    if (bends) {
        if (d->count == PAIRS) {
            slot = d->order[0];
            memmove(d->order, d->order + 1, (PAIRS - 1) * sizeof *d->order);
            d->count--;
        }
        d->order[d->count++] = slot;
        float *restrict s = d->table + 2 * slot * n, *restrict z = s + n;
        for (ptrdiff_t k = 0; k < n; k++)
            s[k] = (float)factor * step[k], z[k] = d->turned[k] - d->steepest[k];
        before[2 * slot] = factor * slope, before[2 * slot + 1] = turned;
    }
    row_products(d->table, 2 * d->count, fresh, n, d->products);
    for (int k = 0; bends && k < d->count; k++) {
        const int other = d->order[k];
        d->sy[slot][other] = 0.0;
        d->sy[other][slot] = d->products[2 * other] - before[2 * other];
        d->yz[slot][other] = d->yz[other][slot] = d->products[2 * other + 1] - before[2 * other + 1];
    }
}
