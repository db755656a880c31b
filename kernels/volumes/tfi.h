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

/* For each direction four laws (4, n) from 0 to 1, of the edges at the (low, low), (high, low), (low, high) and
   (high, high) ends of the two other directions. */
typedef struct {
    const double *xi, *eta, *zeta;
} Laws;

/* A tensor product of cubic B-splines that is added inside: coefficients (3, m1, m2, m3), and for each node along a
   direction the first of four coefficients and their weights. */
typedef struct {
    const double *coefficients;
    ptrdiff_t m1, m2, m3;
    const ptrdiff_t *first[3];
    const double *weights[3];
} Spline3;

/* All nodes of a volume from its faces. 0, or -1 without memory. */
int tfi_volume(double *nodes, const Volume *volume, const Faces *faces, const Laws *laws, const Spline3 *spline,
               int threads);
