/* L-BFGS: steps s and preconditioned changes z = P y of the gradient are rows of one table, in single precision; the
   two-loop recursion runs on the products s·y and y·z. Nocedal and Wright, Numerical Optimization (2006), algorithm
   7.4; the form in products: Chen, Wang and Zhou, NIPS 27 (2014). */
#include "steps.h"
#include "clones.h"
#include "sums.h"
#include "team.h"
#include <math.h>
#include <string.h>

#define TRIES 25  /* lengths of a step that are tried */
#define IDLE 2    /* small changes in a row that count as standing still; one may come from a short step */
#define CHUNK 2048 /* values of every row of the table that are read together */
#define SPAN (64 * CHUNK) /* values of vectors that one sum is over; these are added in their order */
#define ROUND 256  /* sums of threads that are kept until they are added */

/* Sums of `width` numbers over parts of fixed size, added in the order of these, by a team. */
typedef void (*Part)(const void *data, ptrdiff_t k, double *sums);

typedef struct {
    Part part; /* the sums of part k */
    const void *data;
    ptrdiff_t count;
    int width;
    double *sums, found[ROUND][2 * PAIRS];
} Parts;

static void parts_share(void *data, Member member)
{
    Parts *p = data;
    for (ptrdiff_t start = 0; start < p->count; start += ROUND) {
        const ptrdiff_t count = p->count - start < ROUND ? p->count - start : ROUND;
        const Range mine = team_share(count, member);
        for (ptrdiff_t k = mine.first; k < mine.last; k++)
            p->part(p->data, start + k, p->found[k]);
        team_wait(member);
        for (ptrdiff_t k = 0; member.rank == 0 && k < count; k++)
            for (int w = 0; w < p->width; w++)
                p->sums[w] += p->found[k][w];
        team_wait(member);
    }
}

static void add_parts(Part part, const void *data, ptrdiff_t count, int width, int threads, double *sums)
{
    Parts p;
    p.part = part, p.data = data, p.count = count, p.width = width, p.sums = sums;
    memset(sums, 0, (size_t)width * sizeof *sums);
    team_run(threads, parts_share, &p);
}

typedef struct {
    const float *table;
    int rows;
    const double *v;
    ptrdiff_t n;
} Products;

MESHONET_CLONES
static void chunk_products(const void *data, ptrdiff_t k, double *products)
{
    const Products *p = data;
    const ptrdiff_t n = p->n, start = k * CHUNK, stop = start + CHUNK < n ? start + CHUNK : n;
    for (int r = 0; r < p->rows; r++)
        products[r] = product_of_mixed(p->table + r * n + start, p->v + start, stop - start);
}

/* Products of every row of the table (rows, n) with v. */
static void row_products(const float *table, int rows, const double *v, ptrdiff_t n, int threads, double *products)
{
    const Products p = {table, rows, v, n};
    add_parts(chunk_products, &p, (n + CHUNK - 1) / CHUNK, rows, threads, products);
}

/* A new direction, by a team. */
typedef struct {
    const Steps *s;
    const float *share;
    float scale;
} Sum;

/* direction = Σ share[r] row r - scale steepest, in chunks. */
MESHONET_CLONES
static void sum_chunks(const Sum *sum, ptrdiff_t first, ptrdiff_t last)
{
    const Steps *s = sum->s;
    const ptrdiff_t n = s->n;
    const float *restrict steepest = s->steepest, scale = sum->scale;
    float *restrict direction = s->direction;
    for (ptrdiff_t start = first * CHUNK; start < last * CHUNK; start += CHUNK) {
        const ptrdiff_t stop = start + CHUNK < n ? start + CHUNK : n;
        for (ptrdiff_t k = start; k < stop; k++)
            direction[k] = -scale * steepest[k];
        for (int r = 0; r < 2 * s->count; r++) {
            const float *restrict row = s->table + r * n, factor = sum->share[r];
            for (ptrdiff_t k = start; k < stop; k++)
                direction[k] += factor * row[k];
        }
    }
}

TEAM_ROWS(sum_share, Sum, (task->s->n + CHUNK - 1) / CHUNK, sum_chunks)

/* The direction -H g from the gradient and P g, and its slope. */
static double choose_direction(Steps *s)
{
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
    Sum sum = {s, share, (float)scale};
    team_run(s->threads, sum_share, &sum);
    row_products(s->direction, 1, s->gradient, s->n, s->threads, &slope);
    return slope;
}

/* What a step and the gradient's change have in common, over one span. */
enum { STEPS, CHANGES, CURVATURE, TURNED, MEASURES };

MESHONET_CLONES
static void span_change(const void *data, ptrdiff_t span, double *sums)
{
    enum { TOGETHER = 64 };
    const Steps *s = data;
    const ptrdiff_t start = span * SPAN, stop = start + SPAN < s->n ? start + SPAN : s->n;
    memset(sums, 0, MEASURES * sizeof *sums);
    for (ptrdiff_t k = start; k < stop; k += TOGETHER) {
        const ptrdiff_t n = stop - k < TOGETHER ? stop - k : TOGETHER;
        double step[TOGETHER], change[TOGETHER], turned[TOGETHER];
        for (ptrdiff_t l = 0; l < n; l++) {
            step[l] = (double)s->direction[k + l], change[l] = s->fresh[k + l] - s->gradient[k + l];
            turned[l] = (double)(s->turned[k + l] - s->steepest[k + l]);
        }
        sums[STEPS] += product_of(step, step, n), sums[CHANGES] += product_of(change, change, n);
        sums[CURVATURE] += product_of(step, change, n), sums[TURNED] += product_of(s->gradient + k, turned, n);
    }
}

typedef struct {
    Steps *s;
    float factor;
    int slot; /* of the table */
} Remembered;

/* The step and the change of P gradient into the table. */
MESHONET_CLONES
static void keep_step(const Remembered *r, ptrdiff_t first, ptrdiff_t last)
{
    const Steps *s = r->s;
    const float *restrict step = s->direction, factor = r->factor;
    float *restrict moves = s->table + 2 * r->slot * s->n, *restrict z = moves + s->n;
    for (ptrdiff_t k = first; k < last; k++)
        moves[k] = factor * step[k], z[k] = s->turned[k] - s->steepest[k];
}

TEAM_ROWS(kept_share, Remembered, task->s->n, keep_step)

/* Add the step, whose slope was `slope`, the gradient's change y and P y, unless the functional bends down along the
   step; then the products of all rows with the new gradient. Those with y are the changes of these. */
static void remember(Steps *s, double factor, double slope)
{
    double before[2 * PAIRS], change[MEASURES];
    Remembered r = {s, (float)factor, s->count};
    add_parts(span_change, s, (s->n + SPAN - 1) / SPAN, MEASURES, s->threads, change);
    const int bends = change[CURVATURE] > 1e-12 * sqrt(change[STEPS] * change[CHANGES]);
    memcpy(before, s->products, sizeof before);
    if (bends) {
        if (s->count == PAIRS) {
            r.slot = s->order[0];
            memmove(s->order, s->order + 1, (PAIRS - 1) * sizeof *s->order);
            s->count--;
        }
        s->order[s->count++] = r.slot;
        team_run(s->threads, kept_share, &r);
        before[2 * r.slot] = factor * slope, before[2 * r.slot + 1] = change[TURNED];
    }
    row_products(s->table, 2 * s->count, s->fresh, s->n, s->threads, s->products);
    for (int k = 0; bends && k < s->count; k++) {
        const int slot = r.slot, other = s->order[k];
        s->sy[slot][other] = 0.0;
        s->sy[other][slot] = s->products[2 * other] - before[2 * other];
        s->yz[slot][other] = s->yz[other][slot] = s->products[2 * other + 1] - before[2 * other + 1];
    }
}

/* The gradient and P gradient of the step are those here now. */
static void copy_values(const Steps *s, ptrdiff_t first, ptrdiff_t last)
{
    memcpy(s->gradient + first, s->fresh + first, (size_t)(last - first) * sizeof *s->gradient);
    memcpy(s->steepest + first, s->turned + first, (size_t)(last - first) * sizeof *s->steepest);
}

TEAM_ROWS(copy_share, Steps, task->n, copy_values)

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
    team_run(s->threads, copy_share, s);
    /* small steps that still gain, or that were cut short, say nothing of the distance to the minimum */
    const int small = factor * largest < s->still && (factor > 0.4 || largest < s->still);
    s->idle = small && gain < s->gain * value ? s->idle + 1 : 0;
    return s->idle == IDLE ? SETTLED : GOES_ON;
}
