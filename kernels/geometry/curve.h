/* A curve of n intervals, each a cubic a + t (b + t (c + t d)) of 0 <= t <= 1, with a table of arc length of `pieces` to
   an interval. On a piece t is the cubic Hermite inverse of arc length with the slopes at its two ends. */
#pragma once
#include <stddef.h>

/* `table` (n pieces + 1) begins with 0 and does not fall; `start` and `stop` (n pieces) are the slopes of t at the ends
   of every piece, in units of the piece. */
typedef struct {
    const double *table, *start, *stop;
    ptrdiff_t n, pieces;
    int closed;
} ArcLengths;

/* Intervals and places in them, 0 to 1, of arc lengths s (m). A closed curve takes any s, an open one clips it; only
   its very end has the place 1. Neighbours in s that lie near each other on the curve are found quickly. */
void curve_locate(const ArcLengths *curve, const double *s, ptrdiff_t m, ptrdiff_t *interval, double *place);

/* points (m, 2) of the cubics (4, n, 2) at m places; at place 1 it is `end` (2), bit for bit. */
void curve_points(const double *cubic, ptrdiff_t n, const ptrdiff_t *interval, const double *place, ptrdiff_t m,
                  const double *end, double *points);

/* derivatives (m, 2) by t there. */
void curve_slopes(const double *cubic, ptrdiff_t n, const ptrdiff_t *interval, const double *place, ptrdiff_t m,
                  double *derivatives);

/* Lengths (n, m) of the derivatives at the same places (m) of every interval. */
void curve_speeds(const double *cubic, ptrdiff_t n, const double *places, ptrdiff_t m, double *lengths);

/* Values (m, width) at `places` (m) of the spline through `values` (n, width) at rising `knots` (n), of which `bends`
   (n, width) are the second derivatives; outer cubics go on beyond both ends. Values at knots are kept, bit for bit. */
void cubic_values(const double *knots, const double *values, const double *bends, ptrdiff_t n, ptrdiff_t width,
                  const double *places, ptrdiff_t m, double *out);

/* Solve a tridiagonal system of n rows in place of `right` (n, k), by elimination without pivoting: the rows of a
   spline are diagonally dominant. Row i is lower[i] x[i-1] + diagonal[i] x[i] + upper[i] x[i+1]; `ratio` (n) is
   scratch. */
void tridiagonal_solve(const double *lower, const double *diagonal, const double *upper, double *right, ptrdiff_t n,
                       ptrdiff_t k, double *ratio);
