#pragma once
#include <stddef.h>

/* A volume's nodes (n1, n2, n3), k contiguous, of which the three coordinates lie `plane` doubles apart. */
typedef struct {
    ptrdiff_t n1, n2, n3, plane;
} Volume;

/* Six faces, three planes each: west and east (n2, n3), south and north (n1, n3), bottom and top (n1, n2). */
typedef struct {
    const double *west, *east, *south, *north, *bottom, *top;
} Faces;

/* For each direction four laws from 0 to 1, (4, n): of the edges at the low and high ends of the two other directions,
   the first of these fastest: (low, low), (high, low), (low, high), (high, high). */
typedef struct {
    const double *xi, *eta, *zeta;
} Laws;

/* A tensor product of cubic B-splines that is added inside, or none: coefficients three planes of (m1, m2, m3), and for
   each node along a direction the first of four coefficients that reach it and their weights. */
typedef struct {
    const double *coefficients;
    ptrdiff_t m1, m2, m3;
    const ptrdiff_t *first[3];
    const double *weights[3];
} Spline3;

/* All nodes of a volume from its faces. 0, or -1 without memory. */
int tfi_volume(double *nodes, const Volume *volume, const Faces *faces, const Laws *laws, const Spline3 *spline,
               int threads);
