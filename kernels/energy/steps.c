/* What a descent remembers of its steps, and the direction that comes of it.

   Steps s and preconditioned changes z = P y of the gradient are the rows of one table, read once for the products
   with the gradient and once for the new direction; the two-loop recursion runs on the small tables of the products
   s·y and y·z. Rows are in single precision: they steer the descent, they are not its result.

   Nocedal and Wright, Numerical Optimization (2006), algorithm 7.4; the form in products: Chen, Wang and Zhou,
   NIPS 27 (2014). */
#include "steps.h"
#include "clones.h"
#include <math.h>
#include <string.h>

#define TRIES 25  /* lengths of a step that are tried */
#define IDLE 2    /* small changes in a row that count as standing still; one may come from a short step */
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
static double choose_direction(Steps *s)
{
    const ptrdiff_t n = s->n;
    const int count = s->count, *order = s->order;
    const double *products = s->products;
    double alpha[PAIRS], rest[PAIRS], scale = 1.0, slope;
    float share[2 * PAIRS] = {0};
    if (count > 0)
        scale = s->sy[order[count - 1]][order[count - 1]] / s->yz[order[count - 1]][order[count - 1]];
    for (int k = count - 1; k >= 0; k--) {
        double sum = products[2 * order[k]];
        for (int l = k + 1; l < count; l++)
            sum -= s->sy[order[k]][order[l]] * alpha[l];
        alpha[k] = sum / s->sy[order[k]][order[k]];
    }
    for (int k = 0; k < count; k++) {
        double sum = products[2 * order[k] + 1];
        for (int l = 0; l < count; l++)
            sum -= s->yz[order[k]][order[l]] * alpha[l];
        sum *= scale;
        for (int l = 0; l < k; l++)
            sum += rest[l] * s->sy[order[l]][order[k]];
        rest[k] = alpha[k] - sum / s->sy[order[k]][order[k]];
    }
    for (int k = 0; k < count; k++)
        share[2 * order[k]] = (float)-rest[k], share[2 * order[k] + 1] = (float)(scale * alpha[k]);
    row_sum(s->table, 2 * count, share, s->steepest, (float)scale, n, s->direction);
    row_products(s->direction, 1, s->gradient, n, &slope);
    return slope;
}

/* Add the step, whose slope was `slope`, the gradient's change y and P y, unless the functional bends down along the
   step; then the products of all rows with the new gradient. Those with y are the changes of these. */
MESHONET_CLONES
static void remember(Steps *s, double factor, double slope)
{
    const ptrdiff_t n = s->n;
    const double *restrict old = s->gradient, *restrict fresh = s->fresh;
    double before[2 * PAIRS], steps = 0.0, changes = 0.0, curvature = 0.0, turned = 0.0;
    const float *restrict step = s->direction;
    for (ptrdiff_t k = 0; k < n; k++) {
        const double p = (double)step[k], y = fresh[k] - old[k];
        steps += p * p, changes += y * y, curvature += p * y;
        turned += old[k] * (double)(s->turned[k] - s->steepest[k]);
    }
    const int bends = curvature > 1e-12 * sqrt(steps * changes);
    int slot = s->count;
    memcpy(before, s->products, sizeof before);
    if (bends) {
        if (s->count == PAIRS) {
            slot = s->order[0];
            memmove(s->order, s->order + 1, (PAIRS - 1) * sizeof *s->order);
            s->count--;
        }
        s->order[s->count++] = slot;
        float *restrict moves = s->table + 2 * slot * n, *restrict z = moves + n;
        for (ptrdiff_t k = 0; k < n; k++)
            moves[k] = (float)factor * step[k], z[k] = s->turned[k] - s->steepest[k];
        before[2 * slot] = factor * slope, before[2 * slot + 1] = turned;
    }
    row_products(s->table, 2 * s->count, fresh, n, s->products);
    for (int k = 0; bends && k < s->count; k++) {
        const int other = s->order[k];
        s->sy[slot][other] = 0.0;
        s->sy[other][slot] = s->products[2 * other] - before[2 * other];
        s->yz[slot][other] = s->yz[other][slot] = s->products[2 * other + 1] - before[2 * other + 1];
    }
}

double shorter(double rise, double slope)
{
    if (!isfinite(rise))
        return 0.5;
    const double factor = -0.5 * slope / (rise - slope);
    return factor < 0.1 ? 0.1 : factor > 0.5 ? 0.5 : factor;
}

size_t steps_floats(ptrdiff_t n)
{
    return (size_t)((3 + 2 * PAIRS) * n);
}

void steps_place(Steps *s, ptrdiff_t n, double *gradient, double *fresh, float *floats)
{
    s->n = n, s->gradient = gradient, s->fresh = fresh;
    s->direction = floats, s->steepest = floats + n, s->turned = floats + 2 * n, s->table = floats + 3 * n;
}

void steps_start(Steps *s)
{
    s->idle = 0;
    s->value = s->attempt(s->problem, 0.0, &s->smallest);
    memcpy(s->gradient, s->fresh, (size_t)s->n * sizeof *s->gradient);
    steps_forget(s);
}

void steps_forget(Steps *s)
{
    s->count = 0;
    s->precondition(s->problem, s->gradient, s->steepest);
}

int steps_take(Steps *s)
{
    double slope = choose_direction(s);
    if (!(slope < 0.0) && s->count > 0) {
        s->count = 0;
        slope = choose_direction(s);
    }
    if (!(slope < 0.0))
        return STUCK;
    const double largest = s->largest_move(s->problem), limit = s->count == 0 ? s->reach : s->farthest;
    double factor = largest > limit ? limit / largest : 1.0, value = 0.0, low = 0.0;
    int tries = 0;
    for (; tries < TRIES; tries++) {
        value = s->attempt(s->problem, factor, &low);
        if (value <= s->value + 1e-4 * factor * slope)
            break;
        factor *= shorter(value - s->value, factor * slope);
    }
    if (tries == TRIES) { /* what is remembered misleads, or nothing helps */
        const int state = s->count > 0 ? GOES_ON : STUCK;
        s->count = 0;
        return state;
    }
    const double gain = s->value - value;
    s->keep(s->problem);
    s->value = value, s->smallest = low;
    s->precondition(s->problem, s->fresh, s->turned);
    remember(s, factor, slope);
    memcpy(s->gradient, s->fresh, (size_t)s->n * sizeof *s->gradient);
    memcpy(s->steepest, s->turned, (size_t)s->n * sizeof *s->steepest);
    /* small steps that still gain, or that were cut short, say nothing of the distance to the minimum */
    const int small = factor * largest < s->still && (factor > 0.4 || largest < s->still);
    s->idle = small && gain < s->gain * value ? s->idle + 1 : 0;
    return s->idle == IDLE ? SETTLED : GOES_ON;
}
