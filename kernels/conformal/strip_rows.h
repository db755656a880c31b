/* Rows of a grid from the columns of a strip solution; see evaluate.py. */
#pragma once
#include <stddef.h>

#include "lift.h"

#define PANEL_NODES 16 /* as NODES of solvers/conformal/chebyshev.py */
#define TAPS 14 /* as in solvers/conformal/nufft.py */

/* Points [from, from + m) of a row weigh the columns around it: (count, 2, width), count a power of two, width a
   multiple of LANES, zero from m on. */
typedef struct { const double *columns; ptrdiff_t count, from, m, width; } WindowSum;

/* A row is m points: levels 1 .. before the panels, `panels` times PANEL_NODES, levels after them .. nj - 2. */
typedef struct {
    ptrdiff_t n, m;
    double sharpness;
    const WindowSum *sums;
    ptrdiff_t n_sums;
    const double *along, *across; /* (n_nudges, n), (n_nudges, m): their product is added to phi */
    ptrdiff_t n_nudges;
    BodyLift lift;
    const double *matrix;   /* (PANEL_NODES, width): the panels side by side */
    const ptrdiff_t *cuts;  /* (panels + 1) levels, from `begin` on */
    ptrdiff_t panels, begin;
    int symmetric;          /* rows 2k and 2k + 1 of the order are mirror images about this axis */
    Cplx on_axis, turned;   /* a point of it, and its direction squared */
} StripRows;

/* x, y (., nj): levels 1 .. nj - 2 of the `count` rows named in `order`; scratch for 8 (m + LANES) numbers a thread. The
   sum of all points, finite when they are. */
double strip_rows(const StripRows *s, const ptrdiff_t *order, ptrdiff_t count, double *x, double *y, ptrdiff_t nj,
                  int threads, double *scratch);
