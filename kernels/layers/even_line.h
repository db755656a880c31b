/* Nodes along a curve, moved so that the ratio of neighbouring steps is limited in several measures. */
#pragma once
#include <stddef.h>

#include "sparse/factor.h"

/* `measures` functions that increase along the curve: `value` (measures, points) at ascending `arc` (points,), and the
   `slope` (measures, points - 1) between these. With `closed` the curve, and the row of its places, returns to its start. */
typedef struct {
    ptrdiff_t points, measures;
    int closed;
    const double *arc, *value, *slope;
} Measures;

/* The terms of the functional: w max(0, |r| - limit)^2, linear beyond `linear`, and change (r - r0)^2 for logarithms r of
   ratios, `limit` (measures,); stiffness (t - t0)^2 (unknowns,); squares of factors (2 of each) times a pair of places,
   plus `rest`. Ratios that are within `nearly` of their limit are taken as stiff. */
typedef struct {
    const double *limit, *stiffness, *factor, *rest;
    const ptrdiff_t *pair;
    ptrdiff_t links;
    double change, linear, nearly;
} EvenTerms;

/* Steps of Gauss-Newton: the weight w rises from `weight` by `rise` in each to `most`; a step is halved `halvings` times
   at the most until the value falls, and left out if it does not. It ends when no ratio exceeds its `reached` (measures,). */
typedef struct {
    const double *reached;
    double weight, rise, most;
    int steps, halvings;
} EvenSteps;

/* How many entries `slot` has. */
ptrdiff_t even_line_entries(const Measures *measures, const EvenTerms *terms, const ptrdiff_t *unknown, ptrdiff_t places);

/* Move `place` (places,). `unknown` (places,) is the number of each that moves, in their order, -1 for others. `slot` is
   where products of derivatives are in the matrix: the diagonal, pairs 00 01 02 11 12 22 of the places of each ratio that
   move, those of links. Returns 0, k + 1 where row k of the matrix is singular, -1 where memory ran out. */
ptrdiff_t even_line(const Measures *measures, const EvenTerms *terms, const EvenSteps *steps, const SparsePattern *pattern,
                    const ptrdiff_t *slot, const ptrdiff_t *unknown, ptrdiff_t places, double *place);
