/* Nodes of a blade row at and next to the blade. */
#pragma once
#include "channel.h"

/* Cubic splines along the span: values and second derivatives (count, n, 3) of s, theta, h at rising knots (count,). */
typedef struct {
    const double *values, *bends, *knots;
    ptrdiff_t count, n;
} Splines;

/* s, theta (levels, n, 2) where the splines reach heights (levels, n). They are straight beyond the knots. */
void spline_crossings(const Splines *splines, const double *heights, ptrdiff_t levels, double *points);

/* Move columns (n, rows, 3) of s, theta, h, so that they begin at `wall` (n, 2), s and theta, and the first cells are
   `first` high in space. Other nodes move by less and less, the last ones not at all. */
void columns_on_blade(const Channel *channel, const double *wall, double first, ptrdiff_t n, ptrdiff_t rows,
                      double *columns);

/* Move ends (n, 3) of first cells along these, so that the way from `begin` (n, 3) to them has lengths `sizes` (n,) in
   space. */
void lengthen_cells(const Channel *channel, const double *begin, const double *sizes, ptrdiff_t n, double *end);
