/* Each place is looked up in the tables once for all measures, and a step that is kept is evaluated once. */
#include "even_line.h"
#include "clones.h"
#include "elementary.h"
#include "elementary/functions.h"
#include "sums.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define ENDS 3 /* places of a ratio */

/* Places, and of each measure slopes (places,), steps and logarithms of the ratios of these. Steps of closed curves begin
   again after the last. */
typedef struct {
    double *place, *slope, *step, *growth;
} Line;

typedef struct {
    const Measures *measures;
    const EvenTerms *terms;
    const ptrdiff_t *unknown;
    ptrdiff_t places, steps, ratios, unknowns;
    Function logarithm;
    Line now, next;
    double *start, *wanted, *change, *right, *sums, *row; /* row: scratch of twelve rows of places */
    double *matrix, *lower, *pivots;
    int *lower_row;
} Even;

static ptrdiff_t interval(const Measures *m, double place)
{
    ptrdiff_t low = 0, high = m->points; /* the first arc beyond the place is at `high` or before */
    while (low < high) {
        const ptrdiff_t middle = (low + high) / 2;
        if (place < m->arc[middle])
            high = middle;
        else
            low = middle + 1;
    }
    return low < 1 ? 0 : low > m->points - 1 ? m->points - 2 : low - 1;
}

/* A place from 0 to the length of a closed curve, and how many times around it is. */
static double around(double place, double length, double *turns)
{
    double rest = fmod(place, length), count = (place - rest) / length;
    if (rest != 0.0 && (length < 0.0) != (rest < 0.0))
        rest += length, count -= 1.0;
    *turns = floor(count) + (count - floor(count) > 0.5);
    return rest;
}

MESHONET_CLONES
static void look_up(const Measures *m, const ptrdiff_t *restrict k, const double *restrict off, const double *restrict turns,
                    ptrdiff_t places, ptrdiff_t number, double *restrict slope, double *restrict value)
{
    const double *at = m->value + number * m->points, *rise = m->slope + number * (m->points - 1);
    const double whole = at[m->points - 1] - at[0];
    for (ptrdiff_t i = 0; i < places; i++) {
        slope[i] = rise[k[i]];
        value[i] = at[k[i]] + slope[i] * off[i] + turns[i] * whole;
    }
    value[places] = value[0] + whole;
}

/* Evaluate the measures; returns whether all steps are positive. */
static int measure(const Even *e, Line *line)
{
    const Measures *m = e->measures;
    double *off = e->row, *turns = off + e->places, *value = turns + e->places, *logs = value + e->places + 1;
    ptrdiff_t *k = (ptrdiff_t *)(logs + e->places + 1);
    int positive = 1;
    for (ptrdiff_t i = 0; i < e->places; i++) {
        double place = line->place[i];
        turns[i] = 0.0;
        if (m->closed)
            place = around(place, m->arc[m->points - 1], turns + i);
        k[i] = interval(m, place), off[i] = place - m->arc[k[i]];
    }
    for (ptrdiff_t l = 0; l < m->measures; l++) {
        double *step = line->step + l * (e->steps + 1), *growth = line->growth + l * e->ratios;
        look_up(m, k, off, turns, e->places, l, line->slope + l * e->places, value);
        for (ptrdiff_t i = 0; i < e->steps; i++) {
            step[i] = value[i + 1] - value[i];
            positive &= step[i] > 0.0;
        }
        step[e->steps] = step[0];
        e->logarithm(step, e->steps + 1, logs);
        for (ptrdiff_t r = 0; r < e->ratios; r++)
            growth[r] = logs[r + 1] - logs[r];
    }
    return positive;
}

static double linked(const EvenTerms *t, ptrdiff_t k, const double *place)
{
    return t->factor[2 * k] * place[t->pair[2 * k]] + t->factor[2 * k + 1] * place[t->pair[2 * k + 1]] + t->rest[k];
}

MESHONET_CLONES
static double growth_value(const EvenTerms *t, const double *restrict growth, const double *restrict wanted, double limit,
                           double weight, ptrdiff_t ratios, double *restrict each)
{
    for (ptrdiff_t r = 0; r < ratios; r++) {
        const double excess = larger(magnitude(growth[r]) - limit, 0.0), near = smaller(excess, t->linear);
        const double off = growth[r] - wanted[r];
        each[r] = weight * near * (2.0 * excess - near) + t->change * (off * off);
    }
    return sum_of(each, ratios);
}

/* The functional at places that have been measured. */
static double value_of(const Even *e, const Line *line, double weight)
{
    const EvenTerms *t = e->terms;
    double total = 0.0, links = 0.0;
    for (ptrdiff_t l = 0; l < e->measures->measures; l++)
        total += growth_value(t, line->growth + l * e->ratios, e->wanted + l * e->ratios, t->limit[l], weight, e->ratios, e->row);
    for (ptrdiff_t i = 0; i < e->places; i++)
        if (e->unknown[i] >= 0) {
            const double off = line->place[i] - e->start[i];
            e->row[e->unknown[i]] = t->stiffness[e->unknown[i]] * (off * off);
        }
    total += sum_of(e->row, e->unknowns);
    for (ptrdiff_t k = 0; k < t->links; k++) {
        const double own = linked(t, k, line->place);
        links += own * own;
    }
    return total + links;
}

/* Derivatives (3, ratios) of the logarithms of a measure by the places of each, and the weights and slopes of its term. */
MESHONET_CLONES
static void linearise(const EvenTerms *t, const double *restrict step, const double *restrict slope,
                      const double *restrict growth, const double *restrict wanted, double limit, double weight,
                      ptrdiff_t ratios, double *restrict by, double *restrict stiff, double *restrict pulled)
{
    MESHONET_INDEPENDENT
    for (ptrdiff_t r = 0; r < ratios; r++) {
        const double before = step[r], after = step[r + 1], rise = slope[r + 1], size = magnitude(growth[r]);
        const double excess = larger(size - limit, 0.0), pull = weight * smaller(1.0, t->linear / larger(excess, t->linear));
        by[r] = slope[r] / before, by[ratios + r] = -rise / before - rise / after, by[2 * ratios + r] = slope[r + 2] / after;
        stiff[r] = size > limit - t->nearly ? t->change + pull : t->change;
        pulled[r] = t->change * (growth[r] - wanted[r]) + pull * (growth[r] < 0.0 ? -excess : excess);
    }
}

MESHONET_CLONES
static void products(const double *restrict stiff, const double *restrict a, const double *restrict b, ptrdiff_t ratios,
                     double *restrict to)
{
    for (ptrdiff_t r = 0; r < ratios; r++)
        to[r] = stiff[r] * a[r] * b[r];
}

static ptrdiff_t ratios_of(const Measures *m, ptrdiff_t places)
{
    return m->closed ? places : places - 2;
}

ptrdiff_t even_line_entries(const Measures *m, const EvenTerms *t, const ptrdiff_t *unknown, ptrdiff_t places)
{
    ptrdiff_t entries = 0;
    for (ptrdiff_t r = 0; r < ratios_of(m, places); r++)
        for (int a = 0; a < ENDS; a++)
            for (int b = a; b < ENDS; b++)
                entries += unknown[(r + a) % places] >= 0 && unknown[(r + b) % places] >= 0;
    for (ptrdiff_t i = 0; i < places; i++)
        entries += unknown[i] >= 0;
    for (ptrdiff_t k = 0; k < t->links; k++) {
        const int first = unknown[t->pair[2 * k]] >= 0, second = unknown[t->pair[2 * k + 1]] >= 0;
        entries += first + (first && second) + second;
    }
    return entries;
}

/* Add the terms of the ratios of all measures to the matrix and the right side; returns the slots behind those used. */
static const ptrdiff_t *add_ratios(const Even *e, const ptrdiff_t *slots, double weight)
{
    const ptrdiff_t *slot = slots;
    const ptrdiff_t n = e->places, ratios = e->ratios;
    double *slope = e->row, *stiff = slope + n + 2, *pulled = stiff + n, *by = pulled + n, *product = by + ENDS * n;
    for (ptrdiff_t l = 0; l < e->measures->measures; l++) {
        slot = slots;
        memcpy(slope, e->now.slope + l * n, (size_t)n * sizeof *slope);
        slope[n] = slope[0], slope[n + 1] = slope[1];
        linearise(e->terms, e->now.step + l * (e->steps + 1), slope, e->now.growth + l * ratios, e->wanted + l * ratios,
                  e->terms->limit[l], weight, ratios, by, stiff, pulled);
        for (int a = 0; a < ENDS; a++)
            for (int b = a; b < ENDS; b++) {
                products(stiff, by + a * ratios, by + b * ratios, ratios, product);
                for (ptrdiff_t r = 0; r < ratios; r++)
                    if (e->unknown[(r + a) % n] >= 0 && e->unknown[(r + b) % n] >= 0)
                        e->matrix[*slot++] += product[r];
            }
        for (int a = 0; a < ENDS; a++)
            for (ptrdiff_t r = 0; r < ratios; r++)
                if (e->unknown[(r + a) % n] >= 0)
                    e->right[e->unknown[(r + a) % n]] -= pulled[r] * by[a * ratios + r];
    }
    return slot;
}

static void add_links(const Even *e, const ptrdiff_t *slot)
{
    const EvenTerms *t = e->terms;
    for (int a = 0; a < 2; a++)
        for (int b = a; b < 2; b++)
            for (ptrdiff_t k = 0; k < t->links; k++)
                if (e->unknown[t->pair[2 * k + a]] >= 0 && e->unknown[t->pair[2 * k + b]] >= 0)
                    e->matrix[*slot++] += t->factor[2 * k + a] * t->factor[2 * k + b];
    for (int a = 0; a < 2; a++) {
        memset(e->sums, 0, (size_t)e->unknowns * sizeof *e->sums);
        for (ptrdiff_t k = 0; k < t->links; k++)
            if (e->unknown[t->pair[2 * k + a]] >= 0)
                e->sums[e->unknown[t->pair[2 * k + a]]] += linked(t, k, e->now.place) * t->factor[2 * k + a];
        for (ptrdiff_t u = 0; u < e->unknowns; u++)
            e->right[u] -= e->sums[u];
    }
}

/* The step of Gauss-Newton, in `right`; returns as `even_line`. */
static ptrdiff_t solve_step(Even *e, const SparsePattern *pattern, const ptrdiff_t *slot, double weight)
{
    memset(e->matrix, 0, (size_t)pattern->start[pattern->n] * sizeof *e->matrix);
    for (ptrdiff_t i = 0; i < e->places; i++)
        if (e->unknown[i] >= 0) {
            const double stiffness = e->terms->stiffness[e->unknown[i]];
            e->matrix[slot[e->unknown[i]]] += stiffness;
            e->right[e->unknown[i]] = -(stiffness * (e->now.place[i] - e->start[i]));
        }
    add_links(e, add_ratios(e, slot + e->unknowns, weight));
    const ptrdiff_t bad = sparse_factor(pattern, e->matrix, e->lower_row, e->lower, e->pivots);
    if (!bad)
        sparse_solve(pattern, e->lower_row, e->lower, e->pivots, 1, e->right, e->sums);
    return bad;
}

/* Go by the step or the part of it with which the value falls. */
static void descend(Even *e, double weight, int halvings)
{
    const double value = value_of(e, &e->now, weight);
    double share = 1.0;
    for (int k = 0; k < halvings; k++, share *= 0.5) {
        for (ptrdiff_t i = 0; i < e->places; i++)
            e->next.place[i] = e->now.place[i] + (e->unknown[i] >= 0 ? share * e->right[e->unknown[i]] : 0.0);
        if (measure(e, &e->next) && value_of(e, &e->next, weight) < value) {
            const Line kept = e->next;
            e->next = e->now, e->now = kept;
            return;
        }
    }
}

static int within(const Even *e, const double *limit)
{
    for (ptrdiff_t l = 0; l < e->measures->measures; l++)
        for (ptrdiff_t r = 0; r < e->ratios; r++)
            if (magnitude(e->now.growth[l * e->ratios + r]) > limit[l])
                return 0;
    return 1;
}

static Line line_in(const Even *e, double **room)
{
    Line line;
    line.place = *room, line.slope = line.place + e->places, line.step = line.slope + e->measures->measures * e->places;
    line.growth = line.step + e->measures->measures * (e->steps + 1);
    *room = line.growth + e->measures->measures * e->ratios;
    return line;
}

ptrdiff_t even_line(const Measures *measures, const EvenTerms *terms, const EvenSteps *steps, const SparsePattern *pattern,
                    const ptrdiff_t *slot, const ptrdiff_t *unknown, ptrdiff_t places, double *place)
{
    const ptrdiff_t k = measures->measures, n = places, unknowns = pattern->n;
    Even e = {.measures = measures, .terms = terms, .unknown = unknown, .places = n, .unknowns = unknowns};
    e.steps = measures->closed ? n : n - 1, e.ratios = ratios_of(measures, n);
    e.logarithm = function_named("log");
    const ptrdiff_t entries = pattern->start[unknowns], fill = pattern->fill[unknowns];
    const ptrdiff_t doubles = 2 * (n + k * (2 * n + n + 1)) + n + k * n + 3 * unknowns + 12 * (n + 2) + entries + fill;
    double *all = malloc((size_t)(doubles + 1) * sizeof *all), *room = all;
    e.lower_row = malloc((size_t)(fill + 1) * sizeof *e.lower_row);
    ptrdiff_t bad = all && e.lower_row ? 0 : -1;
    if (!bad) {
        e.now = line_in(&e, &room), e.next = line_in(&e, &room);
        e.start = room, e.wanted = e.start + n, e.right = e.wanted + k * n, e.sums = e.right + unknowns;
        e.pivots = e.sums + unknowns, e.row = e.pivots + unknowns, e.matrix = e.row + 12 * (n + 2);
        e.lower = e.matrix + entries;
        memcpy(e.now.place, place, (size_t)n * sizeof *place), memcpy(e.start, place, (size_t)n * sizeof *place);
        measure(&e, &e.now);
        for (ptrdiff_t l = 0; l < k; l++)
            for (ptrdiff_t r = 0; r < e.ratios; r++)
                e.wanted[l * e.ratios + r] = larger(smaller(e.now.growth[l * e.ratios + r], terms->limit[l]), -terms->limit[l]);
        double weight = steps->weight;
        for (int done = 0; done < steps->steps && !bad; done++) {
            weight = smaller(weight * steps->rise, steps->most);
            bad = solve_step(&e, pattern, slot, weight);
            if (bad)
                break;
            descend(&e, weight, steps->halvings);
            if (within(&e, steps->reached))
                break;
        }
        memcpy(place, e.now.place, (size_t)n * sizeof *place);
    }
    free(all), free(e.lower_row);
    return bad;
}
